/** The address defines the view: page, object and settings. Pure functions; the router holds the present address. */
export type Page = 'bench' | 'live' | 'run' | 'runs' | 'units' | 'workbench' | 'alignment' | 'log' | 'settings' | 'lost';

/** The pages with a tab, in the order of their keys. */
export const TABS = ['Bench', 'Live', 'Workbench', 'Runs', 'Units', 'Alignment', 'Log', 'Settings'];
export const hrefOf = (tab: string): string => (tab === TABS[0] ? '/' : `/${tab.toLowerCase()}`);

export interface Route {
	page: Page;
	/** Run of the page, if it has one. */
	run: number | null;
}

export function parseRoute(path: string): Route {
	const [first = '', second, ...rest] = path.split('/').filter(Boolean);
	const run = second === undefined ? null : Number(second);
	const whole = run === null || (Number.isInteger(run) && run > 0);
	if (rest.length || !whole) return { page: 'lost', run: null };
	if (first === '' && run === null) return { page: 'bench', run };
	if (run === null && (first === 'live' || first === 'units' || first === 'alignment' || first === 'log' || first === 'settings')) return { page: first, run };
	if (first === 'runs') return { page: run === null ? 'runs' : 'run', run };
	if (first === 'workbench') return { page: 'workbench', run };
	return { page: 'lost', run: null };
}

/** The query with changed values; `null` or an empty value removes a key, so that addresses stay short. */
export function withQuery(query: URLSearchParams, changes: Record<string, string | number | null>): string {
	const next = new URLSearchParams(query);
	for (const [key, value] of Object.entries(changes)) {
		if (value === null || value === '') next.delete(key);
		else next.set(key, String(value));
	}
	const text = next.toString().replaceAll('%3A', ':').replaceAll('%2C', ',');
	return text ? `?${text}` : '';
}
