import { save } from './download';
import { request } from './request';
import type { Table } from './types';

/** Menu items that save a displayed table. The daemon writes the files, because it has a writer for both formats. */
export function tableFileItems(name: string, shown: () => Table | Promise<Table>, what = '') {
	const saveAs = async (format: string) => {
		const init = { method: 'POST', body: JSON.stringify(await shown()), headers: { 'content-type': 'application/json' } };
		save(await (await request(`/api/v1/tables?format=${format}`, init)).blob(), `${name}.${format}`);
	};
	return ['CSV', 'Parquet'].map((form) => ({ name: form + what, run: () => saveAs(form.toLowerCase()) }));
}
