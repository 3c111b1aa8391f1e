import { expect, it } from 'vitest';
import type { RunSummary } from '../api/types';
import { readHidden, readViews, runsTable, toggleColumn, toggleView } from './look';

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

it('keeps searches and forgets them again', () => {
	const kept = storage();
	toggleView('tag:oil -state:failed', kept);
	toggleView('rows>1000', kept);
	expect(readViews(kept)).toEqual(['tag:oil -state:failed', 'rows>1000']);
	toggleView('tag:oil -state:failed', kept);
	expect(readViews(kept)).toEqual(['rows>1000']);
});

it('writes the list as a table', () => {
	const run = { id: 3, state: 'failed', procedure: 'friction', kind: 'friction', bench: 'a', simulated: true, created_at: '2026-01-02T03:04:05Z', duration_s: 1.5, rows: 7, safe: null, reason: 'no "contact", twice', tags: ['cold', 'new oil'], model: { validation_rms: 0.002, unit: 'Nm', coulomb: { value: 0.03, ci95: [0.029, null] } } };
	const { head, rows } = runsTable([run as unknown as RunSummary]);
	expect(head.slice(-5)).toEqual(['held_out_rms', 'unit', 'coulomb', 'coulomb_low', 'coulomb_high']);
	expect(rows).toEqual([
		[3, 'failed', 'friction', 'friction', 'a', 'true', '2026-01-02T03:04:05Z', 1.5, 7, null, 'no "contact", twice', 'cold new oil', null, 0.002, 'Nm', 0.03, 0.029, null],
	]);
});
