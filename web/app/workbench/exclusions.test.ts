import { expect, it } from 'vitest';
import type { ResidualSet } from '../api/types';
import { exclusionReasons, excludedStretches } from './exclusions';

const set = (time: number[]): ResidualSet => ({
	residual: 'plateau_mean',
	unit: 'Nm',
	axes: [{ name: 'time_s', kind: 'time', unit: 's', values: time }],
	measured: time,
	predicted: time,
	error: time,
	held_out: time.map(() => false),
	excluded: [],
	segment: time,
	repeat: time,
	piece: time,
});

it('joins chosen points that follow each other, whatever their order in the list', () => {
	const found = excludedStretches(set([3, 1, 2, 5, 4, 9]), Uint8Array.from([1, 1, 1, 1, 0, 1]), 1);
	expect(found).toEqual([
		{ from_s: 0.5, to_s: 3.5, points: 3 },
		{ from_s: 4.5, to_s: 5.5, points: 1 },
		{ from_s: 8.5, to_s: 9.5, points: 1 },
	]);
});

it('does not reach over a pause of the run', () => {
	expect(excludedStretches(set([1, 2, 60, 61]), Uint8Array.from([1, 1, 1, 1]), 1).map((one) => one.points)).toEqual([2, 2]);
});

it('sums up by reason', () => {
	const excluded = [
		{ from_s: 0, to_s: 2, reason: 'cold' },
		{ from_s: 5, to_s: 6, reason: 'cable' },
		{ from_s: 7, to_s: 8, reason: 'cold' },
	];
	expect(exclusionReasons(excluded)).toEqual([
		{ reason: 'cold', stretches: 2, seconds: 3 },
		{ reason: 'cable', stretches: 1, seconds: 1 },
	]);
});
