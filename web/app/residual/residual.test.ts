import { describe, expect, it } from 'vitest';
import { improvedRepeats } from './improvedRepeats';
import { binOf, binsFor } from './bins';
import { curve, explainedShare } from './curve';
import { residualMap } from './map';
import { axisLimit } from './meanCurves';
import { emptyCells } from './emptyCells';
import { binMiddle, axisScale } from './axisScale';
import { foldPositions, withDerivedAxes } from './points';
import { bandHalfWidth, quantile, score, BlockSums } from './blockMeans';
import { wholeBins } from './bins';
import { valueAtDepth, colourDepth, mapRange, readMapColour, colouredValue, writeMapColour } from './mapColour';

/** Reproducible noise in −1…1. */
function noise(seed = 1): () => number {
	let state = seed;
	return () => ((state = (state * 16807) % 2147483647) / 2147483647) * 2 - 1;
}
const all = (n: number) => new Uint8Array(n).fill(1);

describe('positions', () => {
	it('are folded into one turn where they go on for more', () => {
		const axis = (name: string, values: number[]) => ({ name, unit: 'rad', values });
		const set = { axes: [axis('link_position_rad', [-1, 1, 7]), axis('motor_position_rad', [-1, 1, 2]), axis('motor_velocity_rad_s', [-9, 9, 9])] };
		const [link, motor, velocity] = foldPositions(set as never).axes.map((one) => one.values);
		expect(link!.map((at) => at.toFixed(3))).toEqual(['5.283', '1.000', '0.717']);
		expect([motor, velocity]).toEqual([[-1, 1, 2], [-9, 9, 9]]);
	});
});

it('has the axes along which the diagnosis looks too', () => {
	const axis = (name: string, values: number[]) => ({ name, unit: '', values });
	const set = { unit: 'Nm', error: [0, 1, 2, 2], predicted: [5, 5, 5, 9], piece: [0, 0, 1, 1], axes: [axis('motor_velocity_rad_s', []), axis('time_s', [0, 1, 3, 4]), axis('motor_position_rad', [0, 7, 14, 5]), axis('direction', [1, 1, -1, -1])] };
	const more = withDerivedAxes(set as never).axes.slice(4);
	expect(more.map(({ name, values }) => [name, values])).toEqual([
		['time_since_reversal_s', [0, 1, 0, 1]],
		['way_since_reversal_rad', [0, 7, 0, 9]],
		['motor_torque_nm', [5.5, 5.5, 7, 11]],
	]);
});

describe('bins', () => {
	it('gives every set point a bin of its own, however dense they are', () => {
		const jitter = noise();
		const set = [-180, -4, -2, 2, 4, 180];
		const values = set.flatMap((level) => Array.from({ length: 12 }, () => level + jitter() * 0.2));
		const { edges, setPoints: levels } = binsFor(values, values.map((_, i) => Math.floor(i / 12)), all(72));
		expect(levels?.map(Math.round)).toEqual(set);
		expect(edges).toHaveLength(7);
		expect(edges[3]).toBeCloseTo(0, 0);
	});

	it('cuts a continuous axis evenly, with a dozen points in each bin', () => {
		const values = Array.from({ length: 120 }, (_, i) => i);
		const { edges, setPoints: levels } = binsFor(values, values.map(() => 1), all(120));
		expect(levels).toBeNull();
		expect(edges).toHaveLength(11);
	});

	it('does not take a slow drift for set points', () => {
		const values = Array.from({ length: 600 }, (_, i) => 20 + i * 0.01);
		expect(binsFor(values, values.map((_, i) => Math.floor(i / 5)), all(600)).setPoints).toBeNull();
	});

	it('draws set points equally wide, and finds the way back', () => {
		const bins = { edges: [-180, -3, 0, 3, 180], setPoints: [-180, -2, 2, 180] };
		const scale = axisScale(bins, 0, 400, 10);
		expect([-180, -3, -1.5, 0, 180].map(scale.at)).toEqual([0, 100, 150, 200, 400]);
		expect([50, 150, 350].map(scale.value)).toEqual([-91.5, -1.5, 91.5]);
		expect(scale.ticks.map(scale.text)).toEqual(['−180', '−2', '2', '180']);
		expect(binMiddle(bins, scale, 3)).toBe(350);
	});

	it('knows the bin of a value', () => {
		expect([0, 0.5, 1, 3, -1, 3.1, Number.NaN].map((v) => binOf([0, 1, 2, 3], v))).toEqual([0, 0, 1, 2, -1, -1, -1]);
	});
});

describe('residuals', () => {
	const random = noise(5);
	const one = new Array<number>(400).fill(1);
	const velocity = Array.from({ length: 400 }, () => random());
	const load = Array.from({ length: 400 }, () => random());
	const residual = load.map((l) => 0.01 * l + 0.001 * random());

	it('gives the axis that matters the largest share', () => {
		const share = (axis: number[]) => explainedShare(axis, binsFor(axis, one, all(400)).edges, residual, all(400));
		expect(share(load)).toBeGreaterThan(0.95);
		expect(share(velocity)).toBeLessThan(0.05);
	});

	it('shows a slope as a slope', () => {
		const { edges } = binsFor(load, one, all(400));
		const points = curve(load, edges, residual, all(400), 0, one);
		expect(points[0]!.mean).toBeCloseTo(-0.0095, 2);
		expect(points.at(-1)!.mean).toBeGreaterThan(0.008);
		expect(points.reduce((n, p) => n + p.n, 0)).toBe(400);
	});

	it('fills the cells of a map and leaves out what is not kept', () => {
		const kept = Uint8Array.from(load, (l) => (l > 0 ? 1 : 0));
		const bins = { edges: [-1, 0, 1], setPoints: null };
		const map = residualMap({ values: velocity, bins }, { values: load, bins }, residual, kept, 0, one);
		expect(map.cells.map((cell) => cell.n > 0)).toEqual([false, false, true, true]);
		expect(map.cells[3]!.mean).toBeGreaterThan(0.003);
	});
});

describe('scores', () => {
	const tally = (values: number[], floor = 0, piece = (i: number) => i) => {
		const sums = new BlockSums();
		values.forEach((value, i) => sums.add(value, piece(i)));
		return sums.mean(floor);
	};
	const ten = [1, 2, 1, 2, 1, 2, 1, 2, 1, 2];

	it('has no colour for fewer than ten points', () => {
		expect(score(tally(ten.slice(1)))).toBeNull();
		expect(score(tally(ten))).toBeCloseTo(9, 9);
	});

	it('counts pieces of the run, not points', () => {
		// Sums of the three blocks about the mean 2: −2, 2, 0, as in the maps of the diagnosis.
		const found = tally([1, 1, 3, 3, 2], 0, (i) => Math.floor(i / 2));
		expect([found.mean, found.blocks]).toEqual([2, 3]);
		expect(found.se).toBeCloseTo(Math.sqrt((8 * 3) / 2) / 5, 12);
		expect(bandHalfWidth(found, 1)! / found.se).toBeCloseTo(4.3027, 4);
		expect(bandHalfWidth(tally(ten, 0, () => 0), 1)).toBeNull();
		const same = tally([0, 4, 0, 4, 0, 4], 0, () => 0);
		expect(same.se).toBeCloseTo(Math.sqrt(4.8 / 6), 12);
	});

	it('has the quantiles of Student', () => {
		const told = [quantile(0.05, 1), quantile(0.05, 2), quantile(0.05, 7), quantile(0.01, 30), quantile(1e-4, 12)];
		[12.7062, 4.3027, 2.3646, 2.75, 5.6945].forEach((t, i) => expect(told[i]).toBeCloseTo(t, 3));
	});

	it('is not surer than the known noise', () => {
		expect(tally([1], 10).se).toBe(10);
		expect(tally(ten, 10).se).toBeCloseTo(10 / Math.sqrt(10), 9);
		expect(score(tally(ten, 10))).toBeCloseTo(1.5 / (10 / Math.sqrt(10)), 9);
	});
});

describe('the colours of the map', () => {
	const cells = [{ n: 100, mean: 3, se: 0.1, blocks: 9 }, { n: 100, mean: -0.5, se: 0.1, blocks: 9 }, { n: 2, mean: 9, se: 0.1, blocks: 2 }];

	it('end at the worst cell, however far that is', () => {
		for (const of of ['errors', 'value'] as const) {
			for (const log of [true, false]) {
				const most = mapRange(cells, of, 0.01);
				const deep = cells.slice(0, 2).map((cell) => colourDepth(colouredValue(cell, of)!, most, { of, log }));
				expect(deep[0]).toBeCloseTo(2, 12);
				expect(deep[1]).toBeLessThan(0);
				expect(deep[1]).toBeGreaterThan(-2);
				expect(valueAtDepth(deep[1]!, most, { of, log })).toBeCloseTo(colouredValue(cells[1]!, of)!, 9);
			}
		}
	});

	it('are pale where there is only noise, and none where there are too few points', () => {
		const noise = [{ n: 100, mean: 0.05, se: 0.1, blocks: 9 }];
		expect(colourDepth(colouredValue(noise[0]!, 'errors')!, mapRange(noise, 'errors', 1), { of: 'errors', log: false })).toBeCloseTo(0.2, 12);
		expect(colourDepth(0.05, mapRange(noise, 'value', 1), { of: 'value', log: false })).toBeCloseTo(0.1, 12);
		expect([colouredValue(cells[2]!, 'errors'), colouredValue(cells[2]!, 'value')]).toEqual([null, null]);
	});

	it('are kept in the address', () => {
		for (const text of ['errors-linear', 'value-log', 'value-linear', null]) expect(writeMapColour(readMapColour(text))).toBe(text);
	});
});

it('frames whole cells: those whose middle lies in the stretch, or the one that holds it', () => {
	const bins = { edges: [0, 1, 2, 3], setPoints: null };
	expect(wholeBins(bins, [0.4, 1.6])).toEqual([0, 2]);
	expect(wholeBins(bins, [1.1, 1.2])).toEqual([1, 2]);
	expect(wholeBins(bins, [2.9, 9])).toEqual([2, 3]);
	expect(wholeBins({ ...bins, setPoints: [0.1, 1, 2.9] }, [0, 0.2])).toEqual([0, 1]);
	expect(wholeBins(bins, null)).toBeNull();
});

it('lets a mean of which little is known make no curve small', () => {
	const point = (mean: number, se: number) => ({ mean, se, n: 50, blocks: 5, from: 0, to: 1 });
	const known = [1, -2, 3].map((mean) => point(mean, 0.1));
	expect(axisLimit([[...known, point(1, 40)]])).toBeCloseTo(axisLimit([known]), 9);
	expect(axisLimit([[...known, point(5, 40)]])).toBeGreaterThan(5);
});

it('counts the repeats that an effect helps', () => {
	const error = [1, 1, 1, -1, 1, 9];
	const set = { error, repeat: [0, 0, 1, 1, 2, 2], held_out: [false, false, false, false, false, true] };
	expect(improvedRepeats(set, [1, 1, 1, 1, 1, 1])).toEqual({ yes: 2, of: 3 });
	expect(improvedRepeats({ ...set, repeat: [0, 0, 0, 0, 0, 0] }, error)).toBeNull();
});

it('names the conditions that were not measured', () => {
	const cell = (n: number) => ({ n, mean: 0, se: 1, blocks: n });
	const x = { edges: [0, 1, 2, 3], setPoints: [0.5, 1.5, 2.5] };
	const map = { x, y: { edges: [0, 10, 20], setPoints: null, factor: 2 }, cells: [0, 0, 4, 0, 4, 0].map(cell) };
	expect(emptyCells(map)).toEqual([
		{ y: [0, 20], x: [0.5, 1.5] },
		{ y: [20, 40], x: [0.5, 0.5] },
		{ y: [20, 40], x: [2.5, 2.5] },
	]);
});
