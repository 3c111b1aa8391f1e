import { expect, it } from 'vitest';
import type { RunSummary } from '../api/types';
import { nextSort, readListView, readBase, readHidden, readQuantities, readSavedViews, readSort, runsTable, sortOrder, toggleBase, toggleColumn, toggleQuantity, toggleSavedView, listViewText, writeListView } from './listView';

function storage() {
	const kept = new Map<string, string>();
	return { getItem: (key: string) => kept.get(key) ?? null, setItem: (key: string, value: string) => void kept.set(key, value) };
}

it('remembers the columns, and lets the address have the last word', () => {
	const kept = storage();
	expect(readHidden(null, kept)).toEqual([]);
	expect(toggleColumn([], 'safe', kept)).toBe('safe');
	expect(readHidden(null, kept)).toEqual(['safe']);
	expect(readHidden('rows,bench,nonsense', kept)).toEqual(['bench', 'rows']);
	expect(toggleColumn(['safe'], 'safe', kept)).toBe('none');
	expect(readHidden(null, kept)).toEqual([]);
});

it('has a column for any quantity, Coulomb friction at first', () => {
	const kept = storage();
	expect(readQuantities(null, kept)).toEqual(['tau_c']);
	expect(toggleQuantity(['tau_c'], 'k', kept)).toBe('tau_c,k');
	expect(readQuantities(null, kept)).toEqual(['tau_c', 'k']);
	expect(readQuantities('c_v,c_v', kept)).toEqual(['c_v']);
	expect(toggleQuantity(['k'], 'k', kept)).toBe('none');
	expect(readQuantities(null, kept)).toEqual([]);
});

it('keeps views and forgets them again', () => {
	const kept = storage();
	kept.setItem('jointbench.runs.views', 'tag:oil -state:failed');
	const [old] = readSavedViews(kept);
	expect(readListView(old!)).toEqual({ search: 'tag:oil -state:failed', sort: null, base: 'none', hide: 'none', columns: 'tau_c' });
	const view = writeListView('rows>1000', '-error', 180, ['bench', 'safe'], ['c_v', 'k']);
	toggleSavedView(view, kept);
	expect(readSavedViews(kept)).toEqual([old, view]);
	expect(readSavedViews(kept).map((one) => listViewText(one, new Map([['c_v', 'Viscous friction']])))).toEqual(['tag:oil -state:failed', 'rows>1000 · by error, largest first · against #180 · with Viscous friction, k · without bench, safe']);
	expect(readListView(view)).toEqual({ search: 'rows>1000', sort: '-error', base: '180', hide: 'bench,safe', columns: 'c_v,k' });
	toggleSavedView(old!, kept);
	expect(readSavedViews(kept)).toEqual([view]);
});

it('reads views of earlier versions as the same view of this version', () => {
	const kept = storage();
	const now = writeListView('tag:oil', null, null, ['safe'], []);
	kept.setItem('jointbench.runs.views', ['?search=tag:oil&base=none&hide=safe,Coulomb', '?search=tag:oil&sort=-coulomb&hide=safe,Coulomb', '?sort=-error&base=7&hide=none'].join('\n'));
	expect(readSavedViews(kept)).toEqual([now, writeListView('', '-error', 7, [], ['tau_c'])]);
	toggleSavedView(now, kept);
	expect(readSavedViews(kept)).toEqual([writeListView('', '-error', 7, [], ['tau_c'])]);
	expect(['-coulomb', 'duration', '-state', null].map(readSort)).toEqual([null, 'duration', '-state', null]);
});

it('orders by a column, the other way round, and no longer', () => {
	expect([null, '-error', 'error'].map((sort) => nextSort(sort, 'error'))).toEqual(['-error', 'error', null]);
	expect([null, 'bench', '-bench'].map((sort) => nextSort(sort, 'bench'))).toEqual(['bench', '-bench', null]);
	expect([sortOrder('-error', 'error'), sortOrder('error', 'error'), sortOrder('error', 'rows'), sortOrder(null, 'note')]).toEqual(['descending', 'ascending', 'none', null]);
});

it('orders by a quantity of the result', () => {
	const column = { quantity: 'tau_c' };
	expect([null, '-quantity:tau_c', 'quantity:tau_c', '-quantity:c_v'].map((sort) => nextSort(sort, column))).toEqual(['-quantity:tau_c', 'quantity:tau_c', null, '-quantity:tau_c']);
	expect([sortOrder('-quantity:tau_c', column), sortOrder('quantity:c_v', column)]).toEqual(['descending', 'none']);
	expect(['-quantity:tau_c', 'quantity:c_v', 'quantities'].map(readSort)).toEqual(['-quantity:tau_c', 'quantity:c_v', null]);
});

it('remembers the base, and lets the address have the last word', () => {
	const kept = storage();
	expect(readBase(null, kept)).toBeNull();
	expect(toggleBase(null, 7, kept)).toBe('7');
	expect([readBase(null, kept), readBase('9', kept), readBase('none', kept)]).toEqual([7, 9, null]);
	expect(toggleBase(7, 7, kept)).toBe('none');
	expect(readBase(null, kept)).toBeNull();
});

it('writes the list as a table', () => {
	const run = { id: 3, state: 'failed', procedure: 'friction', kind: 'friction', bench: 'a', simulated: true, created_at: '2026-01-02T03:04:05Z', duration_s: 1.5, rows: 7, safe: null, reason: 'no "contact", twice', tags: ['cold', 'new oil'], unit: { serial: 'SN1', batch: '7' }, operator: 'A. Smith', model: { validation_rms: 0.002, unit: 'Nm' } };
	const tau_c = { name: 'tau_c', symbol: 'τ_c', title: 'Coulomb friction', unit: 'Nm', value: 0.031, ci95: [0.03, 0.032] };
	const { head, rows } = runsTable([run as unknown as RunSummary], ['tau_c', 'k'], new Map([[3, [tau_c]]]));
	expect(head.slice(-10)).toEqual(['held_out_rms', 'unit', 'tau_c', 'tau_c_low', 'tau_c_high', 'tau_c_unit', 'k', 'k_low', 'k_high', 'k_unit']);
	expect(rows).toEqual([
		[3, 'failed', 'friction', 'friction', 'a', 'true', '2026-01-02T03:04:05Z', 1.5, 7, null, 'no "contact", twice', 'cold new oil', null, 'SN1', null, null, '7', 'A. Smith', 0.002, 'Nm', 0.031, 0.03, 0.032, 'Nm', null, null, null, null],
	]);
});
