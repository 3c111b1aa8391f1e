import { expect, it } from 'vitest';
import type { Trends } from '../api/types';
import { trendQuantities, trendFigure } from './trendFigure';

const quantity = (name: string, value: number, ci95: [number, number] | null = null) => ({ name, symbol: '', title: name.toUpperCase(), unit: 'Nm', value, ci95 });
const run = (id: number, minute: number, more: object) => ({ run: id, created_at: `2026-11-26T10:${String(minute).padStart(2, '0')}:00Z`, bench: 'a', procedure: 'friction', tags: [], temperature_c: null, quantities: [], ...more });
const trends = {
	pending: 0,
	left_out: 0,
	runs: [
		run(3, 0, { quantities: [quantity('tau_c', 0.1, [0.09, 0.11]), quantity('b', 2)], temperature_c: 21 }),
		run(4, 5, { quantities: [quantity('tau_c', 0.2)], bench: 'b' }),
		run(6, 10, { quantities: [quantity('tau_c', 0.3, [0.2, 0.4])], temperature_c: 25, tags: ['oil'] }),
	],
} as unknown as Trends;
const same = (unit: string) => ({ factor: 1, unit });

const results = trends.runs.map(({ quantities }) => quantities);

it('offers every quantity, the most frequent first', () => {
	expect(trendQuantities(results).map(({ name, n }) => [name, n])).toEqual([['tau_c', 3], ['b', 1]]);
	const other = { ...quantity('tau_c', 0.4), title: 'Torque at the start of sliding' };
	expect(trendQuantities([[other], ...results]).map(({ title, n }) => [title, n])).toEqual([['TAU_C', 3], ['B', 1]]);
	const mixed = { ...trends, runs: [{ ...trends.runs[0]!, quantities: [other] }, ...trends.runs.slice(1)] };
	expect(trendFigure(mixed, 'tau_c', 'run', same)!.x.names).toEqual(['#4', '#6']);
});

it('keeps a quantity together whose title contains a measured speed', () => {
	const delay = (speed: number) => ({ ...quantity('delay_1', speed / 1e4), title: `Delay, +${speed} rad/s`, base_title: 'Delay', configuration: `+${speed} rad/s` });
	const measured = { ...trends, runs: [52.3, 52.4].map((speed, i) => run(i + 1, i, { quantities: [delay(speed)] })) } as unknown as Trends;
	const quantities = measured.runs.map((one) => one.quantities);
	expect(trendQuantities(quantities).map(({ title, base_title, n }) => [title, base_title, n])).toEqual([['Delay (delay_1)', 'Delay', 2]]);
	expect(trendQuantities(quantities.slice(1)).map(({ title }) => title)).toEqual(['Delay, +52.4 rad/s']);
	expect(trendFigure(measured, 'delay_1', 'run', same)!.x.names).toEqual(['#1', '#2']);
});

it('lays a quantity over runs with its intervals, each bench by itself', () => {
	const figure = trendFigure(trends, 'tau_c', 'run', same)!;
	expect(figure.x.names).toEqual(['#3', '#4', '#6']);
	expect(figure.series.map(({ label, x, y }) => [label, x, y])).toEqual([['a', [0, 2], [0.1, 0.3]], ['b', [1], [0.2]]]);
	expect(figure.series[0]?.band).toEqual([[0.09, 0.11], [0.2, 0.4]]);
	// Without an interval, the band has zero height.
	expect(figure.series[1]?.band).toEqual([[0.2, 0.2]]);
});

it('lays it over temperature, time and tag; a run without a temperature has no place there', () => {
	expect(trendFigure(trends, 'tau_c', 'temperature', same)?.series.map(({ x }) => x)).toEqual([[21, 25]]);
	const time = trendFigure(trends, 'tau_c', 'time', same)!;
	expect([time.x.unit, time.series[0]?.x, time.series[1]?.x]).toEqual(['min', [0, 10], [5]]);
	expect(trendFigure(trends, 'tau_c', 'tag', same)?.x.names).toEqual(['no tag', 'oil']);
	expect(trendFigure(trends, 'tau_c', 'run', () => ({ factor: 1000, unit: 'mNm' }))?.series[0]?.y).toEqual([100, 300]);
	expect(trendFigure(trends, 'gone', 'run', same)).toBeNull();
});
