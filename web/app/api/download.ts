import { request } from './ask';

/** Fetches a file and hands it to the person: an ordinary link can carry no token, and would save a refusal as if it were the file. */
export async function download(href: string, name: string): Promise<void> {
	const answer = await request(href);
	save(await answer.blob(), /filename="([^"]+)"/.exec(answer.headers.get('content-disposition') ?? '')?.[1] ?? name);
}

/** Hands a file to the person. */
export function save(file: Blob, name: string): void {
	const link = document.createElement('a');
	link.href = URL.createObjectURL(file);
	link.download = name;
	link.click();
	URL.revokeObjectURL(link.href);
}
