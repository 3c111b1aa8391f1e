import { request } from './request';
import { BASE } from './client';
import type { ImportPreview, Run } from './types';

/** A run table, with its `meta.json` if there is one. */
export interface Upload {
	file: File;
	meta: File | null;
}

/** Import options under the daemon's names: `map`, `unit`, `time_from_rate` … */
export type ImportOptions = Record<string, string[]>;

/** Pairs files that were dropped together: one `.json` is used for all tables. */
export function pairWithMeta(files: readonly File[]): Upload[] {
	const meta = files.find((file) => file.name.endsWith('.json')) ?? null;
	return files.filter((file) => !file.name.endsWith('.json')).map((file) => ({ file, meta }));
}

/** Sent as a form, which the typed client does not support. */
async function send(address: string, { file, meta }: Upload, choices: ImportOptions): Promise<unknown> {
	const form = new FormData();
	form.append('file', file, file.name);
	if (meta) form.append('meta', await meta.text());
	for (const [part, list] of Object.entries(choices)) for (const one of list) form.append(part, one);
	const answer = await request(`${BASE}${address}`, { method: 'POST', body: form });
	return await answer.json();
}

export const importRun = async (upload: Upload, choices: ImportOptions = {}): Promise<Run> => (await send('/runs/import', upload, choices)) as Run;

/** The daemon's interpretation of a file; nothing is stored. */
export const previewImport = async (upload: Upload, choices: ImportOptions = {}): Promise<ImportPreview> => (await send('/runs/import/preview', upload, choices)) as ImportPreview;
