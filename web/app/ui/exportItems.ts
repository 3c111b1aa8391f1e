import { save } from '../api/download';
import { tableFileItems } from '../api/tableFiles';
import type { Table } from '../api/types';
import { pngFile, svgFile } from '../figure/exportImage';
import { router } from '../state/router.svelte';

/** Plots that are displayed as tables; the address stores their names. */
export const isShownAsTable = (file: string): boolean => router.list('table').includes(file);

export const tableToggleItem = (file: string) => ({ name: isShownAsTable(file) ? 'View as plot' : 'View as table', run: () => router.toggle('table', file) });

/** Without loopback or TLS, a browser blocks access to its clipboard. */
export const linkItems = () => (navigator.clipboard ? [{ name: 'Copy the link to this view', run: () => void navigator.clipboard.writeText(location.href) }] : []);

/** `host`: the drawing, while it is displayed. */
export const exportItems = (title: string, file: string, host: Element | false | undefined, shown: () => Table) => [
	...(host
		? [
				{ name: 'PNG', run: async () => save(await pngFile(host, title), `${file}.png`) },
				{ name: 'SVG', run: () => save(svgFile(host, title), `${file}.svg`) },
			]
		: []),
	...tableFileItems(file, shown),
	...linkItems(),
];
