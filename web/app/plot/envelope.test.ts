import { expect, it } from 'vitest';
import { envelope, findGaps, joinColumns } from './envelope';

it('draws a spike of one sample', () => {
	const drawn = envelope({ time_s: [0, 1], rows: 2000, exact: false, channels: [{ name: 'x', unit: 'A', min: [0, -0.1], max: [0.1, 9] }] });
	expect(drawn.time).toEqual([0, 0, 1, 1]);
	expect(drawn.columns[0]).toEqual([0, 0.1, -0.1, 9]);
});

it('finds pauses, also between steps of unlike length', () => {
	const even = Array.from({ length: 20 }, (_, i) => i * 0.1);
	expect(findGaps(even)).toEqual([]);
	expect(findGaps([...even, 5, 5.1])).toEqual([[even.at(-1), 5]]);
});

it('puts what the store has before what was heard, and nothing twice', () => {
	const both = joinColumns([[0, 1, 2], [5, null, 7]], [Float64Array.of(2, 3), Float32Array.of(8, 9)]);
	expect(both.map((column) => Array.from(column))).toEqual([
		[0, 1, 2, 3],
		[5, Number.NaN, 8, 9],
	]);
	expect(joinColumns([[0, 1, 2], []], [Float64Array.of(2, 3), Float32Array.of(8, 9)])[1]).toEqual([null, null, 8, 9]);
});
