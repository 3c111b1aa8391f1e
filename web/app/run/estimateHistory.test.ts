import { expect, it } from 'vitest';
import type { IdentifiedQuantity } from '../api/types';
import { lastChange, intervalHistory } from './estimateHistory';

it('shows how an interval has shrunk, on the scale of the later ones', () => {
	const said = (at_s: number, ci95: [number, number] | null) => ({ at_s, quantities: [{ name: 'a', ci95 }] as unknown as IdentifiedQuantity[] });
	const points = intervalHistory([said(0, null), said(10, [-100, 100]), said(20, [0, 4]), said(30, [1, 3])], 'a');
	expect(points.map((one) => one.x)).toEqual([0, 0.5, 1]);
	expect(points[0]).toMatchObject({ low: 1, high: 0 });
	const wide = points.map((one) => one.low - one.high);
	expect(wide[1]).toBeGreaterThan(wide[2]!);
	expect(wide[2]).toBeGreaterThan(0);
	expect(intervalHistory([], 'a')).toEqual([]);
});

it('says what changed last, and nothing of what was there from the first', () => {
	const said = (at_s: number, ...names: string[]) => ({ at_s, quantities: names.map((name) => ({ name, title: `the ${name}`, ci95: [0, 1] })) as unknown as IdentifiedQuantity[] });
	expect(lastChange([])).toBe(null);
	expect(lastChange([said(0), said(4, 'a'), said(8, 'a')])).toBe(null);
	expect(lastChange([said(0), said(4, 'a'), said(8, 'a', 'b'), said(12, 'a', 'b')])).toContain('From 8 s on found now: the b.');
	expect(lastChange([said(4, 'a', 'b'), said(8, 'a', 'c')])).toContain('found now: the c; no longer found: the b.');
	const wide = { at_s: 16, quantities: [{ name: 'a', title: 'the a', ci95: [0, 2] }] as unknown as IdentifiedQuantity[] };
	expect(lastChange([said(4, 'a'), said(8, 'a'), wide, wide])).toContain('From 16 s on 1 of 1 intervals wider.');
});
