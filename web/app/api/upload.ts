import { request } from './ask';
import { BASE } from './client';
import type { Run } from './types';

/** A run table and, beside it, its `meta.json`. */
export interface Upload {
	file: File;
	meta: File | null;
}

/** Puts the files that were dropped together into pairs: one `.json` serves all tables of the drop. */
export function pair(files: readonly File[]): Upload[] {
	const meta = files.find((file) => file.name.endsWith('.json')) ?? null;
	return files.filter((file) => !file.name.endsWith('.json')).map((file) => ({ file, meta }));
}

/** Sent as a form, which the typed client does not build. */
export async function importRun({ file, meta }: Upload, columns: { map?: string[]; scale?: string[]; leave?: string[]; leave_empty_rows?: string[] } = {}): Promise<Run> {
	const form = new FormData();
	form.append('file', file, file.name);
	if (meta) form.append('meta', await meta.text());
	for (const [part, list] of Object.entries(columns)) for (const one of list) form.append(part, one);
	const answer = await request(`${BASE}/runs/import`, { method: 'POST', body: form });
	return (await answer.json()) as Run;
}
