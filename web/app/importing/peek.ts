/** The first lines of a text table, read in the browser; `null` for files that only the daemon can read. */
export interface Head {
	headers: string[];
	rows: string[][];
}

const ENOUGH_BYTES = 64 * 1024;
const ROWS = 6;

export async function peek(file: File): Promise<Head | null> {
	if (!/\.csv(\.gz)?$/i.test(file.name)) return null;
	const stream = file.name.toLowerCase().endsWith('.gz') ? file.stream().pipeThrough(new DecompressionStream('gzip')) : file.stream();
	return parseHead(await beginning(stream, ENOUGH_BYTES));
}

async function beginning(stream: ReadableStream<Uint8Array>, bytes: number): Promise<string> {
	const reader = stream.getReader();
	const decoder = new TextDecoder();
	let text = '';
	let taken = 0;
	while (taken < bytes) {
		const { done, value } = await reader.read();
		if (done) break;
		taken += value.length;
		text += decoder.decode(value, { stream: true });
	}
	await reader.cancel();
	return text;
}

export function parseHead(text: string): Head {
	const lines = text.replace(/^\ufeff/, '').split(/\r?\n/).filter((line) => line !== '');
	const count = (sign: string) => (lines[0] ?? '').replace(/"[^"]*"/g, '').split(sign).length;
	/** As the daemon decides: what is most frequent in the line of names. */
	const separator = [',', ';', '\t'].reduce((best, one) => (count(one) > count(best) ? one : best));
	const cells = (line: string) => line.split(separator).map((cell) => cell.trim().replace(/^"(.*)"$/, '$1'));
	return { headers: cells(lines[0] ?? ''), rows: lines.slice(1, 1 + ROWS).map(cells) };
}
