import { expect, it } from 'vitest';
import type { IdentifiedQuantity } from '../api/types';
import { funnel } from './soFar';

it('shows how an interval has shrunk, on the scale of the later ones', () => {
	const said = (at_s: number, ci95: [number, number] | null) => ({ at_s, quantities: [{ name: 'a', ci95 }] as unknown as IdentifiedQuantity[] });
	const points = funnel([said(0, null), said(10, [-100, 100]), said(20, [0, 4]), said(30, [1, 3])], 'a');
	expect(points.map((one) => one.x)).toEqual([0, 0.5, 1]);
	expect(points[0]).toMatchObject({ low: 1, high: 0 });
	const wide = points.map((one) => one.low - one.high);
	expect(wide[1]).toBeGreaterThan(wide[2]!);
	expect(wide[2]).toBeGreaterThan(0);
	expect(funnel([], 'a')).toEqual([]);
});
