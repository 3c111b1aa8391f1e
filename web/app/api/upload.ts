import { request } from './ask';
import { BASE } from './client';
import type { ImportPreview, Run } from './types';

/** A run table and, beside it, its `meta.json`. */
export interface Upload {
	file: File;
	meta: File | null;
}

/** What to do to a file, by the names of the daemon: `map`, `unit`, `time_from_rate` … */
export type Choices = Record<string, string[]>;

/** Puts the files that were dropped together into pairs: one `.json` serves all tables of the drop. */
export function pair(files: readonly File[]): Upload[] {
	const meta = files.find((file) => file.name.endsWith('.json')) ?? null;
	return files.filter((file) => !file.name.endsWith('.json')).map((file) => ({ file, meta }));
}

/** Sent as a form, which the typed client does not build. */
async function send(address: string, { file, meta }: Upload, choices: Choices): Promise<unknown> {
	const form = new FormData();
	form.append('file', file, file.name);
	if (meta) form.append('meta', await meta.text());
	for (const [part, list] of Object.entries(choices)) for (const one of list) form.append(part, one);
	const answer = await request(`${BASE}${address}`, { method: 'POST', body: form });
	return await answer.json();
}

export const importRun = async (upload: Upload, choices: Choices = {}): Promise<Run> => (await send('/runs/import', upload, choices)) as Run;

/** What the daemon understands of a file; nothing of it is kept. */
export const previewImport = async (upload: Upload, choices: Choices = {}): Promise<ImportPreview> => (await send('/runs/import/preview', upload, choices)) as ImportPreview;
