import { expect, it } from 'vitest';
import type { Parameter } from '../api/types';
import { ellipses } from './ellipse';

const parameter = (name: string, ci95: [number | null, number | null]) => ({ effect: 'e', name, value: 1, unit: 'Nm', ci95, state: 'ok' }) as Parameter;
const parameters = [parameter('a', [0.9, 1.1]), parameter('b', [0, 2]), parameter('c', [null, 2])];

it('draws the joint region of two parameters, the strongest pair first', () => {
	const found = ellipses(parameters, [{ first: 'e.a', second: 'e.b', correlation: 0.5 }, { first: 'e.b', second: 'e.a', correlation: -0.95 }]);
	expect(found.map(({ correlation }) => correlation)).toEqual([-0.95, 0.5]);
	const { outline } = found[0]!;
	// The joint region is 25 % wider than each single interval and is along the falling diagonal.
	expect(Math.max(...outline.map(([x]) => x))).toBeCloseTo(1.249, 3);
	expect(Math.max(...outline.map(([, y]) => y))).toBeCloseTo(1.249, 2);
	const [, y] = outline.reduce((right, one) => (one[0] > right[0] ? one : right));
	expect(y).toBeCloseTo(-0.95 * 1.249, 3);
});

it('has no region for what has no interval', () => {
	expect(ellipses(parameters, [{ first: 'e.a', second: 'e.c', correlation: 0.99 }, { first: 'e.a', second: 'e.gone', correlation: 0.99 }])).toEqual([]);
});
