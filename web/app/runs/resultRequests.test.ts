import { expect, it } from 'vitest';
import type { RunSummary, Trends } from '../api/types';
import { runsTable } from './listView';
import { idRanges, quantitiesOf, repetition, withAnswer } from './resultRequests';

const tau_c = { name: 'tau_c', symbol: 'τ_c', title: 'Coulomb friction', unit: 'Nm', value: 0.03, ci95: [0.02, 0.04] };

it('requests contiguous groups of runs, each within one answer', () => {
	expect(idRanges([1007, 3, 1009, 1008])).toEqual([[3, 3], [1007, 1009]]);
	expect(idRanges([])).toEqual([]);
	const many = Array.from({ length: 200_000 }, (_, i) => i + 1);
	const ranges = idRanges(many);
	expect([ranges.length, ranges[0], ranges.at(-1)]).toEqual([400, [1, 500], [199_501, 200_000]]);
});

it('knows that a run has no result only from a complete answer', () => {
	const runs = [{ run: 3, quantities: [tau_c] }] as unknown as Trends['runs'];
	expect([...withAnswer(new Map(), [3, 4], { runs, pending: 1 })]).toEqual([[3, [tau_c]]]);
	expect([...withAnswer(new Map(), [3, 4], { runs, pending: 0 })]).toEqual([[3, [tau_c]], [4, []]]);
});

it('repeats a request after progress, and a few times without', () => {
	const isRepeated = repetition();
	expect(isRepeated([4], 100)).toBe(true);
	for (let pending = 99; pending > 80; pending -= 1) expect(isRepeated([4], pending)).toBe(true);
	expect([81, 82, 81, 82, 81].map((pending) => isRepeated([4], pending))).toEqual([true, true, true, true, false]);
	expect(isRepeated([5], 81)).toBe(true);
	expect(isRepeated([], 0)).toBe(false);
});

it('lists and exports the value of the model of an imported run', () => {
	const imported = { id: 8, procedure: 'import', tags: [], model: { unit: 'Nm', coulomb: { name: 'tau_c', unit: 'Nm', value: 0.05, ci95: [0.04, 0.06] } } } as unknown as RunSummary;
	const results = new Map([imported, { ...imported, id: 9, procedure: 'friction' }].map((run) => [run.id, quantitiesOf(new Map(), run)]));
	expect(results.get(8)).toMatchObject([{ name: 'tau_c', symbol: 'τ_c', title: 'Coulomb friction of the model', value: 0.05 }]);
	expect(results.get(9)).toEqual([]);
	expect(runsTable([imported], ['tau_c'], results).rows[0]!.slice(-4)).toEqual([0.05, 0.04, 0.06, 'Nm']);
});
