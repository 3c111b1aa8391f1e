import { describe, expect, it } from 'vitest';
import type { Model, Parameter, ResidualSet, Suggestion } from '../api/types';
import { parameterRows } from './parameterRows';
import { overlay } from './overlay';
import { rankAxes } from './rankedAxes';
import { readZoom, writeZoom } from './zoom';
import { readRegion, evidenceKind, writeRegion, writeAxisRange } from './region';
import { selectedShares } from '../residual/meanCurves';
import { regionSamples } from '../residual/regionSamples';
import { branches, pathTo, childWith, gain, stepName, undecided } from './versionTree';
import { barsOf, effectLosses, lossMark, axisTop } from './waterfall';

const version = (id: number, parent: number | null, effects: string[], held: number, added: string[] = []): Model =>
	({ id, parent, effects, added, removed: [], run: 1, more_runs: [], excluded: [], validation_rms: held, rms: held * 0.9, fit: { parameters: [] } }) as unknown as Model;

const models = [
	version(1, null, ['coulomb'], 10),
	version(2, 1, ['coulomb', 'stribeck'], 4, ['stribeck']),
	version(3, 1, ['coulomb', 'load_linear'], 8, ['load_linear']),
	version(4, 2, ['coulomb', 'stribeck', 'load_linear'], 1, ['load_linear']),
];

describe('the tree of versions', () => {
	it('knows the way from the root', () => {
		expect(pathTo(models, 4).map((model) => model.id)).toEqual([1, 2, 4]);
		expect(pathTo(models, 99)).toEqual([]);
	});

	it('visits a set that was fitted before instead of fitting it again', () => {
		expect(childWith(models, models[1]!, ['load_linear', 'coulomb', 'stribeck'])?.id).toBe(4);
		expect(childWith(models, models[2]!, ['load_linear', 'coulomb', 'stribeck'])).toBeUndefined();
	});

	it('holds no version for the same effects with other settings of their parameters', () => {
		const fixed = { effect: 'coulomb', name: 'tau_c', fixed: 0.03 };
		const withSettings = (model: Model): Model => ({ ...model, fit: { ...model.fit, settings: [fixed] } });
		const [parent, child] = [version(1, null, ['coulomb'], 2), version(2, 1, ['coulomb', 'viscous'], 1)];
		const wanted = ['coulomb', 'viscous'];
		expect(childWith([parent, withSettings(child)], parent, wanted)).toBeUndefined();
		expect(childWith([parent, withSettings(child)], withSettings(parent), wanted)?.id).toBe(2);
		expect(childWith([parent, child], withSettings(parent), ['viscous', 'coulomb'])).toBeUndefined();
		expect(stepName(withSettings(version(3, 1, ['coulomb'], 2)), parent)).toBe('parameters set');
		expect(stepName(version(3, 1, ['coulomb'], 2), withSettings(parent))).toBe('parameters free');
	});

	it('holds no version for the same that was fitted on more runs', () => {
		const more = { ...version(5, 2, ['coulomb', 'stribeck'], 5), more_runs: [2] };
		expect(childWith([...models, more], models[1]!, ['coulomb', 'stribeck'])).toBeUndefined();
		expect(stepName(more)).toBe('with run 2');
		expect(barsOf([models[1]!, more], null).map((bar) => bar.change)).toEqual([null, null]);
	});

	it('holds versions that look at other samples apart, and says so', () => {
		const excluded = [{ from_s: 1, to_s: 2, reason: 'cable touched' }];
		const less = { ...version(5, 2, ['coulomb', 'stribeck'], 5), added: [], excluded };
		expect(childWith([...models, less], models[1]!, ['coulomb', 'stribeck'])).toBeUndefined();
		expect(stepName(less, models[1])).toBe('without some samples');
		expect(stepName({ ...less, id: 6, parent: 5, excluded: [] }, less)).toBe('with samples again');
		expect(barsOf([models[1]!, less], null).map((bar) => bar.change)).toEqual([null, null]);
	});

	it('lists children under their parents', () => {
		expect(branches(models).map(({ model, depth, forks, ends }) => [model.id, depth, forks, ends])).toEqual([
			[1, 0, false, false],
			[2, 1, true, false],
			[4, 1, false, true],
			[3, 0, false, true],
		]);
	});

	it('tells what an added effect leaves undecided', () => {
		const fitted = (model: Model, states: Record<string, string>) =>
			({ ...model, fit: { parameters: Object.entries(states).map(([id, state]) => ({ effect: id.split('.')[0], name: id.split('.')[1], state })) } }) as unknown as Model;
		const before = fitted(models[0]!, { 'coulomb.tau_c': 'ok', 'viscous.c_v': 'unidentified' });
		const after = (states: Record<string, string>) => undecided(before, fitted(version(6, 1, [], 1, ['bump']), { 'viscous.c_v': 'unidentified', ...states }));
		expect(after({ 'coulomb.tau_c': 'unidentified', 'bump.a': 'unidentified', 'bump.w': 'at_bound' })).toEqual(['bump', 'coulomb.tau_c']);
		expect(after({ 'coulomb.tau_c': 'ok', 'bump.a': 'ok', 'bump.w': 'unidentified' })).toEqual([]);
	});

	it('names what a version did', () => {
		expect(models.map((model) => stepName(model))).toEqual(['start', '+ stribeck', '+ load linear', '+ load linear']);
		expect(gain(models[0]!, models[1]!)).toBeCloseTo(0.6, 12);
	});
});

it('lets the waterfall end with what would come next', () => {
	const next = { effect: 'gravity', validation_rms: 0.5, error_reduction: 0.5 } as Suggestion;
	const bars = barsOf(pathTo(models, 4), next);
	expect(bars.map((bar) => [bar.label, bar.validation])).toEqual([
		['start', 10],
		['+ stribeck', 4],
		['+ load linear', 1],
		['+ gravity?', 0.5],
	]);
	expect(bars[1]!.change).toBeCloseTo(-0.6, 12);
	expect(axisTop(bars, 0.3)).toBeGreaterThan(10);
});

it('says what would be lost, the most first', () => {
	const losses = effectLosses([
		{ effect: 'viscous', without_rms: 2 },
		{ effect: 'coulomb', without_rms: 9 },
		{ effect: 'inertia', without_rms: null, reason: 'nothing to fit' },
	]);
	expect(losses).toEqual([
		{ effect: 'coulomb', without: 9 },
		{ effect: 'viscous', without: 2 },
	]);
	expect([lossMark(['viscous'], losses), lossMark(['inertia'], losses), lossMark(['viscous', 'coulomb'], losses)]).toEqual([2, null, null]);
});

describe('regions', () => {
	it('live in the address', () => {
		const stretch = { axis: 'motor_velocity_rad_s', from: -3.25, to: 8 };
		expect(readRegion(writeAxisRange(stretch))).toEqual([stretch]);
		const rectangle = [stretch, { axis: 'load', from: 0, to: 1 }];
		expect(readRegion(writeRegion(rectangle))).toEqual(rectangle);
		expect(readRegion('motor_velocity_rad_s:1')).toBeNull();
		expect(readRegion(null)).toBeNull();
		expect(readZoom(writeZoom([1.5, 2]))).toEqual([1.5, 2]);
		expect(readZoom('2:1')).toBeNull();
	});

	it('are the samples for which all stretches hold, on the chosen side', () => {
		const set = {
			axes: [
				{ name: 'direction', unit: '1', values: [1, 1, -1, 1] },
				{ name: 'load', unit: 'Nm', values: [5, 5, 5, 9] },
			],
			measured: [1, 2, 2, 2],
			error: [0, 0, 0, 0],
			held_out: [false, false, false, false],
			excluded: [],
		} as unknown as ResidualSet;
		const region = [
			{ axis: 'load', from: 4, to: 6 },
			{ axis: 'measured', from: 1.5, to: 3 },
		];
		expect([...regionSamples(set, region, 'both', false)!]).toEqual([0, 1, 1, 0]);
		expect([...regionSamples(set, region, 'negative', false)!]).toEqual([0, 0, 1, 0]);
		expect(regionSamples(set, [{ axis: 'absent', from: 0, to: 1 }], 'both', false)).toBeNull();
		const bins = { edges: [0, 4, 10], setPoints: null };
		expect(selectedShares(set.axes[1]!.values, bins, new Uint8Array([1, 1, 1, 1]), new Uint8Array([0, 1, 1, 0]))).toEqual([0, 0.5]);
	});

	it('are seen in the overlay, whatever its axis', () => {
		const set = {
			axes: [
				{ name: 'time_s', unit: 's', values: [3, 1, 2] },
				{ name: 'load', unit: 'Nm', values: [5, 0, 9] },
			],
			measured: [30, 10, 20],
			predicted: [31, 11, 21],
			error: [-1, -1, -1],
			held_out: [false, true, false],
			excluded: [],
		} as unknown as ResidualSet;
		const chosen = regionSamples(set, [{ axis: 'load', from: 4, to: 6 }], 'both', true);
		const times = set.axes[0]!.values;
		const drawn = overlay(set, times, chosen, 1000, true);
		expect(drawn.x).toEqual([1, 2, 3]);
		expect(drawn.measuredInside).toEqual([null, null, 30]);
		expect(drawn.measuredOutside).toEqual([10, null, null]);
		expect(drawn.residual).toEqual([null, -1000, null]);
		expect(overlay(set, times, null, 1, false).x).toEqual([2, 3]);
	});
});

it('says how strong the evidence is', () => {
	expect(evidenceKind({ evidence: 'small', confounded_with: [] })).toBe('small');
	expect(evidenceKind({ evidence: 'strong', confounded_with: ['drift'] })).toBe('confounded');
});

it('flags parameters in words', () => {
	const rows = parameterRows([
		{ value: 2, ci95: [1, 3], state: 'ok' },
		{ value: -2, ci95: [-5, 1], state: 'at_bound' },
		{ value: 1, ci95: [null, null], state: 'unidentified' },
		{ value: 3, ci95: [3, 3], state: 'ok' },
	] as Parameter[]);
	expect(rows.map((row) => row.interval)).toEqual([[0.5, 1.5], [-0.5, 2.5], null, null]);
	expect(rows.map((row) => row.flags)).toEqual([[], ['at its bound', 'may be zero'], ['not decided by this data', 'no interval'], []]);
	const pair = ['a', 'b'].map((name) => ({ effect: 'e', name, value: 1, ci95: [0.5, 1.5], state: 'ok' })) as Parameter[];
	const [first] = parameterRows(pair, [{ first: 'e.a', second: 'e.b', correlation: -0.96 }]);
	expect(first!.flags).toEqual(['ρ −0.96 with e.b']);
});

describe('the axes that explain the residual', () => {
	const axis = (name: string, kind: string, unit: string, values: number[]) => ({ name, kind, unit, values });
	const points = Array.from({ length: 800 }, (_, i) => i);
	const way = points.map((i) => (i % 2 ? 1 : -1));
	const pressure = points.map((i) => (i >> 1) % 5);
	const left = (one: (i: number) => number) =>
		({
			axes: [axis('direction', 'direction', '', way), axis('oil_pressure_pa', 'other', 'Pa', pressure)],
			error: points.map((i) => one(i) + 0.01 * Math.sin(37 * i)),
			excluded: points.map(() => false),
			held_out: points.map(() => false),
			segment: points.map((i) => i >> 3),
			piece: points.map((i) => i >> 3),
		}) as unknown as ResidualSet;
	const shares = (set: ResidualSet) =>
		rankAxes(set, set.error, 'both', false, 0).map(({ axis, share, splitShare: split }) => [axis.name, Math.round(100 * share), Math.round(100 * split)]);

	it('tells what shows only with each direction for itself', () => {
		expect(shares(left((i) => (pressure[i] === 2 ? way[i]! : 0)))).toEqual([['oil_pressure_pa', 0, 80], ['direction', 20, 0]]);
	});

	it('uses set points only for quantities that a run controls', () => {
		const set = left(() => 0);
		const setPointsOf = (kind: string) => {
			const axes = set.axes.map((one) => (one.name === 'direction' ? one : { ...one, kind })) as ResidualSet['axes'];
			const found = rankAxes({ ...set, axes, segment: pressure }, set.error, 'both', false, 0);
			return found.find((one) => one.axis.name === 'oil_pressure_pa')!.bins.setPoints;
		};
		expect(setPointsOf('load')).toHaveLength(5);
		for (const kind of ['time', 'temperature', 'position', 'response']) expect(setPointsOf(kind)).toBeNull();
	});

	it('gives no axis what the direction alone decides', () => {
		expect(shares(left((i) => way[i]!))).toEqual([['direction', 100, 0], ['oil_pressure_pa', 0, 0]]);
	});
});
