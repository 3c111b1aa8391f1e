/** File names of run tables and facts. */
const TABLE_FILE = /\.(csv|tsv|txt|dat|asc|log|lvm|parquet|arrow|feather|json)(\.gz)?$/i;

/**
 * All files of a drop: the content of folders, and unpacked zip archives. Both ignore other files than tables and
 * facts.
 */
export async function unpack(files: readonly File[]): Promise<File[]> {
	const all = await Promise.all(files.map(async (file) => (/\.zip$/i.test(file.name) ? await unzip(file) : [file])));
	return all.flat();
}

/** The files of a dropped folder and of its subfolders. */
export async function filesOf(entry: FileSystemEntry): Promise<File[]> {
	if (entry.isFile) return [await new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject))];
	const reader = (entry as FileSystemDirectoryEntry).createReader();
	const found: File[] = [];
	for (;;) {
		const some = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
		// The reader returns a hundred entries at a time, and none after the last.
		if (some.length === 0) break;
		for (const one of some) found.push(...(await filesOf(one)));
	}
	return found.filter(({ name }) => TABLE_FILE.test(name));
}

const END = 0x06054b50;
const ENTRY = 0x02014b50;
/** Range of the end record at the end of the file: its 22 bytes and a comment. */
const TAIL_BYTES = 22 + 0xffff;
/** Limit for all unpacked files of an archive together. */
const MAX_BYTES = 4 * 2 ** 30;

/** The tables of a zip archive. Source: PKWARE APPNOTE.TXT 6.3.10, 4.3.12 and 4.3.16. */
export async function unzip(archive: File): Promise<File[]> {
	const bytes = new DataView(await archive.arrayBuffer());
	const broken = () => new Error(`${archive.name} is no whole zip archive: pack it again`);
	let end = bytes.byteLength - 22;
	while (end >= 0 && end >= bytes.byteLength - TAIL_BYTES && bytes.getUint32(end, true) !== END) end -= 1;
	if (end < 0 || bytes.getUint32(end, true) !== END) throw broken();
	const found: File[] = [];
	let at = bytes.getUint32(end + 16, true);
	let total = 0;
	for (let count = bytes.getUint16(end + 10, true); count > 0; count -= 1) {
		if (at + 46 > bytes.byteLength || bytes.getUint32(at, true) !== ENTRY) throw broken();
		const [method, packed, size, from] = [bytes.getUint16(at + 10, true), bytes.getUint32(at + 20, true), bytes.getUint32(at + 24, true), bytes.getUint32(at + 42, true)];
		const [named, extra, comment] = [bytes.getUint16(at + 28, true), bytes.getUint16(at + 30, true), bytes.getUint16(at + 32, true)];
		const name = new TextDecoder().decode(new Uint8Array(bytes.buffer, at + 46, named));
		at += 46 + named + extra + comment;
		if (!TABLE_FILE.test(name) || name.startsWith('__MACOSX/')) continue;
		total += size;
		if (total > MAX_BYTES) throw new Error(`${archive.name} unpacks to more than 4 GiB: import its files one by one`);
		if (from + 30 > bytes.byteLength) throw broken();
		const start = from + 30 + bytes.getUint16(from + 26, true) + bytes.getUint16(from + 28, true);
		const piece = archive.slice(start, start + packed);
		if (method !== 0 && method !== 8) throw new Error(`${name} in ${archive.name} is packed in a way that browsers do not unpack: unpack it first`);
		const plain = method === 0 ? piece : await new Response(piece.stream().pipeThrough(new DecompressionStream('deflate-raw'))).blob();
		found.push(new File([plain], name.split('/').at(-1) ?? name));
	}
	return found;
}
