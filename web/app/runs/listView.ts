import type { IdentifiedQuantity, RunSummary, Table } from '../api/types';
import { withQuery } from '../state/route';
import { toggled } from '../state/toggled';

/**
 * Columns of the list in addition to the number and state of a run and to quantities of its result. The user selects
 * them, and the browser stores them.
 */
export const COLUMNS = ['procedure', 'unit', 'bench', 'started', 'duration', 'rows', 'safe', 'error', 'change', 'note'] as const;
export type Column = (typeof COLUMNS)[number];

const HIDDEN = 'jointbench.runs.hidden';
const QUANTITIES = 'jointbench.runs.quantities';
const DEFAULT_QUANTITIES = 'tau_c';
const VIEWS = 'jointbench.runs.views';
const BASE = 'jointbench.runs.base';
/** A view does not depend on what this browser stores. */
const NOTHING_KEPT = { getItem: () => null };

/** Hidden columns: from the address, or from this browser; `none` hides nothing. */
export function readHidden(address: string | null, kept: Pick<Storage, 'getItem'>): Column[] {
	const names = (address ?? kept.getItem(HIDDEN) ?? '').split(',');
	return COLUMNS.filter((one) => names.includes(one));
}

/** Shows or hides a column and stores it. Returns the value for the address. */
export function toggleColumn(hidden: readonly Column[], column: Column, kept: Pick<Storage, 'setItem'>): string {
	const text = toggled(hidden, column).join(',') || 'none';
	kept.setItem(HIDDEN, text);
	return text;
}

/** Names of quantities with a column: from the address, or from this browser; `none` for none. */
export function readQuantities(address: string | null, kept: Pick<Storage, 'getItem'>): string[] {
	const text = address ?? kept.getItem(QUANTITIES) ?? DEFAULT_QUANTITIES;
	return text === 'none' ? [] : [...new Set(text.split(',').filter(Boolean))];
}

/** Adds or removes a column and stores it. Returns the value for the address. */
export function toggleQuantity(shown: readonly string[], name: string, kept: Pick<Storage, 'setItem'>): string {
	const text = toggled(shown, name).join(',') || 'none';
	kept.setItem(QUANTITIES, text);
	return text;
}

/** The base run for comparisons: from the address, or from this browser; `none` for none. */
export function readBase(address: string | null, kept: Pick<Storage, 'getItem'>): number | null {
	const id = Number(address ?? kept.getItem(BASE));
	return Number.isInteger(id) && id > 0 ? id : null;
}

/** Selects or clears the base run and stores it. Returns the value for the address. */
export function toggleBase(base: number | null, id: number, kept: Pick<Storage, 'setItem'>): string {
	const text = base === id ? 'none' : String(id);
	kept.setItem(BASE, text);
	return text;
}

/** Sort keys of the list under the daemon's names; numbers start with the largest. */
const SORTS: Partial<Record<Column | 'state', string>> = { state: 'state', procedure: 'procedure', bench: 'bench', started: 'started', duration: '-duration', rows: '-rows', safe: 'safe', error: '-error' };
const reversed = (sort: string) => (sort.startsWith('-') ? sort.slice(1) : `-${sort}`);

const QUANTITY_PREFIX = 'quantity:';
const isQuantitySort = (sort: string) => sort.replace(/^-/, '').startsWith(QUANTITY_PREFIX);

/** A sortable column: one of the list, or a quantity by its name. */
export type SortColumn = Column | 'state' | { quantity: string };

const ownOrder = (column: SortColumn): string | undefined => (typeof column === 'object' ? `-${QUANTITY_PREFIX}${column.quantity}` : SORTS[column]);

/** The order of an address; `null` for a column without a head, such as `-coulomb` of earlier versions. */
export const readSort = (address: string | null): string | null =>
	address !== null && (Object.values(SORTS).some((own) => address === own || address === reversed(own)) || isQuantitySort(address)) ? address : null;

/** Present sort order of a column; `null` if it cannot be sorted. */
export function sortOrder(sort: string | null, column: SortColumn): 'ascending' | 'descending' | 'none' | null {
	const own = ownOrder(column);
	if (own === undefined) return null;
	return sort === own || sort === reversed(own) ? (sort.startsWith('-') ? 'descending' : 'ascending') : 'none';
}

/** Order after another click on a column: its own order, then reversed, then newest first. */
export function nextSort(sort: string | null, column: SortColumn): string | null {
	const own = ownOrder(column)!;
	return sort === own ? reversed(own) : sort === reversed(own) ? null : own;
}

/** A view of the list as an address: search, order, base run and columns. */
export const writeListView = (search: string, sort: string | null, base: number | null, hidden: readonly Column[], quantities: readonly string[]): string =>
	withQuery(new URLSearchParams(), { search, sort, base: base ?? 'none', hide: hidden.join(',') || 'none', columns: quantities.join() || 'none' });

/** All settings of a view's address, for the router. */
export function readListView(view: string): Record<string, string | null> {
	const query = new URLSearchParams(view);
	return { ...Object.fromEntries(['search', 'base', 'hide', 'columns'].map((key) => [key, query.get(key)])), sort: readSort(query.get('sort')) };
}

/** A view in words, with the known titles of quantities. */
export function listViewText(view: string, titles: ReadonlyMap<string, string>): string {
	const { search, sort, base, hide, columns } = readListView(view);
	const quantities = readQuantities(columns ?? null, NOTHING_KEPT);
	const hidden = readHidden(hide ?? 'none', NOTHING_KEPT);
	return [
		search || 'all runs',
		...(sort ? [`by ${sort.replace('-', '')}${sort.startsWith('-') ? ', largest first' : ''}`] : []),
		...(base && base !== 'none' ? [`against #${base}`] : []),
		...(quantities.length > 0 && quantities.join() !== DEFAULT_QUANTITIES ? [`with ${quantities.map((name) => titles.get(name) ?? name).join(', ')}`] : []),
		...(hidden.length > 0 ? [`without ${hidden.join(', ')}`] : []),
	].join(' · ');
}

/** A saved line as this version writes it: earlier versions saved only the search, or had a column `Coulomb`. */
function savedView(line: string): string {
	const { search, sort, base, hide, columns } = line.startsWith('?') ? readListView(line) : { search: line };
	const quantities = columns ?? (hide?.split(',').includes('Coulomb') ? 'none' : DEFAULT_QUANTITIES);
	return writeListView(search ?? '', sort ?? null, readBase(base ?? 'none', NOTHING_KEPT), readHidden(hide ?? 'none', NOTHING_KEPT), readQuantities(quantities, NOTHING_KEPT));
}

/** Saved views, in the order of saving. */
export const readSavedViews = (kept: Pick<Storage, 'getItem'>): string[] => [...new Set((kept.getItem(VIEWS) ?? '').split('\n').filter(Boolean).map(savedView))];

export function toggleSavedView(view: string, kept: Pick<Storage, 'getItem' | 'setItem'>): void {
	kept.setItem(VIEWS, toggled(readSavedViews(kept), view).join('\n'));
}

const FIELDS = ['id', 'state', 'procedure', 'kind', 'bench', 'simulated', 'created_at', 'duration_s', 'rows', 'safe', 'reason', 'tags', 'note'] as const;
const UNIT_FIELDS = ['serial', 'part', 'revision', 'batch'] as const;

/** The list as a table for other programs, with the shown quantities of the results. */
export function runsTable(runs: readonly RunSummary[], shown: readonly string[], results: ReadonlyMap<number, readonly IdentifiedQuantity[]>): Table {
	const cell = (value: unknown) => (Array.isArray(value) ? value.join(' ') : typeof value === 'number' ? value : value == null ? null : String(value));
	const quantities = (run: RunSummary) =>
		shown.flatMap((name) => {
			const of = results.get(run.id)?.find((one) => one.name === name);
			return [of?.value, of?.ci95?.[0], of?.ci95?.[1], of?.unit];
		});
	const head = [...FIELDS, ...UNIT_FIELDS, 'operator', 'held_out_rms', 'unit', ...shown.flatMap((name) => [name, `${name}_low`, `${name}_high`, `${name}_unit`])];
	return { head, rows: runs.map((run) => [...FIELDS.map((field) => run[field]), ...UNIT_FIELDS.map((field) => run.unit?.[field]), run.operator, run.model?.validation_rms, run.model?.unit, ...quantities(run)].map(cell)) };
}
