import { save } from '../api/download';
import { tableItems } from '../api/tableFiles';
import type { Table } from '../api/types';
import { pngFile, svgFile } from '../figure/exportImage';
import { router } from '../state/router.svelte';

const named = () => router.query.get('table')?.split(',').filter((one) => one !== '') ?? [];

/** Plots that are displayed as tables; the address stores their names. */
export const isTable = (file: string | undefined): boolean => file !== undefined && named().includes(file);

export function turnItem(file: string | undefined) {
	const table = isTable(file);
	const turn = () => router.set({ table: (table ? named().filter((one) => one !== file) : [...named(), file]).join(',') || null });
	return { name: table ? 'View as plot' : 'View as table', run: turn };
}

/** Without loopback or TLS, a browser blocks access to its clipboard. */
export const linkItems = () => (navigator.clipboard ? [{ name: 'Copy the link to this view', run: () => void navigator.clipboard.writeText(location.href) }] : []);

/** `host`: the drawing, while it is displayed. */
export const takeItems = (title: string, file: string, host: Element | false | undefined, shown: () => Table) => [
	...(host
		? [
				{ name: 'PNG', run: async () => save(await pngFile(host, title), `${file}.png`) },
				{ name: 'SVG', run: () => save(svgFile(host, title), `${file}.svg`) },
			]
		: []),
	...tableItems(file, shown),
	...linkItems(),
];
