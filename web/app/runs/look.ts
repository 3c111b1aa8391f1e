import type { RunSummary, Table } from '../api/types';

/** What the list can show of a run beside its number and its state; a person chooses, and the browser remembers. */
export const COLUMNS = ['procedure', 'bench', 'started', 'duration', 'rows', 'safe', 'error', 'Coulomb', 'note'] as const;
export type Column = (typeof COLUMNS)[number];

const HIDDEN = 'jointbench.runs.hidden';
const VIEWS = 'jointbench.runs.views';

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

/** Searches that were kept, in the order in which they were. */
export const readViews = (kept: Pick<Storage, 'getItem'>): string[] => (kept.getItem(VIEWS) ?? '').split('\n').filter(Boolean);

export function toggleView(search: string, kept: Pick<Storage, 'getItem' | 'setItem'>): void {
	const views = readViews(kept);
	kept.setItem(VIEWS, (views.includes(search) ? views.filter((one) => one !== search) : [...views, search]).join('\n'));
}

const FIELDS = ['id', 'state', 'procedure', 'kind', 'bench', 'simulated', 'created_at', 'duration_s', 'rows', 'safe', 'reason', 'tags', 'note'] as const;

/** The list as a table for other programs. */
export function runsTable(runs: readonly RunSummary[]): Table {
	const cell = (value: unknown) => (Array.isArray(value) ? value.join(' ') : typeof value === 'number' ? value : value == null ? null : String(value));
	const model = ({ model }: RunSummary) => [model?.validation_rms, model?.unit, model?.coulomb?.value, ...(model?.coulomb?.ci95 ?? [null, null])];
	const head = [...FIELDS, 'held_out_rms', 'unit', 'coulomb', 'coulomb_low', 'coulomb_high'];
	return { head, rows: runs.map((run) => [...FIELDS.map((field) => run[field]), ...model(run)].map(cell)) };
}
