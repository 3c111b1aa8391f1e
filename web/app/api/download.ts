import { request } from './request';

/**
 * Fetches a file and saves it. An ordinary link cannot carry a token, and would save an error document under the file's
 * name.
 */
export async function download(href: string, name: string): Promise<void> {
	const answer = await request(href);
	save(await answer.blob(), /filename="([^"]+)"/.exec(answer.headers.get('content-disposition') ?? '')?.[1] ?? name);
}

/** Saves a file in the browser. */
export function save(file: Blob, name: string): void {
	const link = document.createElement('a');
	link.href = URL.createObjectURL(file);
	link.download = name;
	link.click();
	URL.revokeObjectURL(link.href);
}
