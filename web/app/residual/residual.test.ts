import { describe, expect, it } from 'vitest';
import { binOf, binsFor } from './bins';
import { curve, explainedShare } from './curve';
import { residualMap } from './map';
import { score, Sums } from './tally';

/** Repeatable noise in −1…1. */
function noise(seed = 1): () => number {
	let state = seed;
	return () => ((state = (state * 16807) % 2147483647) / 2147483647) * 2 - 1;
}
const all = (n: number) => new Uint8Array(n).fill(1);

describe('bins', () => {
	it('puts set points into bins of their own', () => {
		const jitter = noise();
		const values = [-20, -5, 5, 20].flatMap((level) => Array.from({ length: 12 }, () => level + jitter() * 0.01));
		const { edges, levels } = binsFor(values);
		expect(levels).toBe(true);
		expect(edges).toHaveLength(5);
		expect(edges[2]).toBeCloseTo(0, 1);
	});

	it('cuts a continuous axis evenly, with a dozen points in each bin', () => {
		const { edges, levels } = binsFor(Array.from({ length: 120 }, (_, i) => i));
		expect(levels).toBe(false);
		expect(edges).toHaveLength(11);
	});

	it('knows the bin of a value', () => {
		expect([0, 0.5, 1, 3, -1, 3.1, Number.NaN].map((v) => binOf([0, 1, 2, 3], v))).toEqual([0, 0, 1, 2, -1, -1, -1]);
	});
});

describe('residuals', () => {
	const random = noise(5);
	const velocity = Array.from({ length: 400 }, () => random());
	const load = Array.from({ length: 400 }, () => random());
	const residual = load.map((l) => 0.01 * l + 0.001 * random());

	it('gives the axis that matters the largest share', () => {
		const share = (axis: number[]) => explainedShare(axis, binsFor(axis).edges, residual, all(400));
		expect(share(load)).toBeGreaterThan(0.95);
		expect(share(velocity)).toBeLessThan(0.05);
	});

	it('shows a slope as a slope', () => {
		const { edges } = binsFor(load);
		const points = curve(load, edges, residual, all(400), 0);
		expect(points[0]!.mean).toBeCloseTo(-0.0095, 2);
		expect(points.at(-1)!.mean).toBeGreaterThan(0.008);
		expect(points.reduce((n, p) => n + p.n, 0)).toBe(400);
	});

	it('fills the cells of a map and leaves out what is not kept', () => {
		const kept = Uint8Array.from(load, (l) => (l > 0 ? 1 : 0));
		const edges = [-1, 0, 1];
		const map = residualMap({ values: velocity, edges }, { values: load, edges }, residual, kept, 0);
		expect(map.cells.map((cell) => cell.n > 0)).toEqual([false, false, true, true]);
		expect(map.cells[3]!.mean).toBeGreaterThan(0.003);
	});
});

describe('scores', () => {
	const tally = (values: number[], floor = 0) => {
		const sums = new Sums();
		values.forEach((value) => sums.add(value));
		return sums.tally(floor);
	};
	const ten = [1, 2, 1, 2, 1, 2, 1, 2, 1, 2];

	it('has no colour for fewer than ten points', () => {
		expect(score(tally(ten.slice(1)))).toBeNull();
		expect(score(tally(ten))).toBe(5);
	});

	it('is not surer than the known noise', () => {
		expect(tally(ten, 10).se).toBeCloseTo(10 / Math.sqrt(10), 9);
		expect(score(tally(ten, 10))).toBeCloseTo(1.5 / (10 / Math.sqrt(10)), 9);
	});
});
