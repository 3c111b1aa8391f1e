import type { RunSummary, Table } from '../api/types';
import { withQuery } from '../state/route';

/** What the list can show of a run beside its number and its state; a person chooses, and the browser remembers. */
export const COLUMNS = ['procedure', 'bench', 'started', 'duration', 'rows', 'safe', 'error', 'change', 'Coulomb', 'note'] as const;
export type Column = (typeof COLUMNS)[number];

const HIDDEN = 'jointbench.runs.hidden';
const VIEWS = 'jointbench.runs.views';
const BASE = 'jointbench.runs.base';

/** Columns that are not shown: as the address says, or as this browser was left; `none` hides nothing. */
export function readHidden(address: string | null, kept: Pick<Storage, 'getItem'>): Column[] {
	const names = (address ?? kept.getItem(HIDDEN) ?? '').split(',');
	return COLUMNS.filter((one) => names.includes(one));
}

/** Shows or hides a column and remembers it; what the address is to say. */
export function toggleColumn(hidden: readonly Column[], column: Column, kept: Pick<Storage, 'setItem'>): string {
	const next = hidden.includes(column) ? hidden.filter((one) => one !== column) : [...hidden, column];
	const text = next.join(',') || 'none';
	kept.setItem(HIDDEN, text);
	return text;
}

/** The run that the others are held against: as the address says, or as this browser was left; `none` for none. */
export function readBase(address: string | null, kept: Pick<Storage, 'getItem'>): number | null {
	const id = Number(address ?? kept.getItem(BASE));
	return Number.isInteger(id) && id > 0 ? id : null;
}

/** Makes a run the base, or no longer, and remembers it; what the address is to say. */
export function toggleBase(base: number | null, id: number, kept: Pick<Storage, 'setItem'>): string {
	const text = base === id ? 'none' : String(id);
	kept.setItem(BASE, text);
	return text;
}

/** By what the list can be ordered, as the daemon calls it; figures begin with the largest. */
const SORTS: Partial<Record<Column | 'state', string>> = { state: 'state', procedure: 'procedure', bench: 'bench', started: 'started', duration: '-duration', rows: '-rows', safe: 'safe', error: '-error', Coulomb: '-coulomb' };
const turned = (sort: string) => (sort.startsWith('-') ? sort.slice(1) : `-${sort}`);

/** How a column orders the list at the moment; `null` where it cannot. */
export function sorted(sort: string | null, column: Column | 'state'): 'ascending' | 'descending' | 'none' | null {
	const own = SORTS[column];
	if (own === undefined) return null;
	return sort === own || sort === turned(own) ? (sort.startsWith('-') ? 'descending' : 'ascending') : 'none';
}

/** A column chosen once more: its own order, then the other way round, then the newest first again. */
export function nextSort(sort: string | null, column: Column | 'state'): string | null {
	const own = SORTS[column]!;
	return sort === own ? turned(own) : sort === turned(own) ? null : own;
}

/** What makes a view of the list, as an address: what is searched for, in which order, against which run, and which columns. */
export const viewOf = (search: string, sort: string | null, base: number | null, hidden: readonly Column[]): string =>
	withQuery(new URLSearchParams(), { search, sort, base: base ?? 'none', hide: hidden.join(',') || 'none' });

/** All that an address of a view sets, for the router. */
export function ofView(view: string): Record<string, string | null> {
	const query = new URLSearchParams(view);
	return Object.fromEntries(['search', 'sort', 'base', 'hide'].map((key) => [key, query.get(key)]));
}

/** A view in words. */
export function viewName(view: string): string {
	const { search, sort, base, hide } = ofView(view);
	const hidden = readHidden(hide ?? 'none', { getItem: () => null });
	return [
		search || 'all runs',
		...(sort ? [`by ${sort.replace('-', '')}${sort.startsWith('-') ? ', largest first' : ''}`] : []),
		...(base && base !== 'none' ? [`against #${base}`] : []),
		...(hidden.length > 0 ? [`without ${hidden.join(', ')}`] : []),
	].join(' · ');
}

/** Views that were kept, in the order in which they were. Earlier versions kept the search alone. */
export const readViews = (kept: Pick<Storage, 'getItem'>): string[] =>
	(kept.getItem(VIEWS) ?? '').split('\n').filter(Boolean).map((line) => (line.startsWith('?') ? line : viewOf(line, null, null, [])));

export function toggleView(view: string, kept: Pick<Storage, 'getItem' | 'setItem'>): void {
	const views = readViews(kept);
	kept.setItem(VIEWS, (views.includes(view) ? views.filter((one) => one !== view) : [...views, view]).join('\n'));
}

const FIELDS = ['id', 'state', 'procedure', 'kind', 'bench', 'simulated', 'created_at', 'duration_s', 'rows', 'safe', 'reason', 'tags', 'note'] as const;

/** The list as a table for other programs. */
export function runsTable(runs: readonly RunSummary[]): Table {
	const cell = (value: unknown) => (Array.isArray(value) ? value.join(' ') : typeof value === 'number' ? value : value == null ? null : String(value));
	const model = ({ model }: RunSummary) => [model?.validation_rms, model?.unit, model?.coulomb?.value, ...(model?.coulomb?.ci95 ?? [null, null])];
	const head = [...FIELDS, 'held_out_rms', 'unit', 'coulomb', 'coulomb_low', 'coulomb_high'];
	return { head, rows: runs.map((run) => [...FIELDS.map((field) => run[field]), ...model(run)].map(cell)) };
}
