import { expect, it } from 'vitest';
import type { ControlChart } from '../api/types';
import { controlFigure, emptyText, indexText } from './controlChart';

const point = (unit: string, value: number, violates: ControlChart['points'][number]['violates'] = []) => ({ unit, batch: null, run: 1, created_at: '2026-01-01T00:00:00Z', value, ci95: [value - 0.1, value + 0.1], violates });
const chart: ControlChart = {
	procedure: 'friction', quantity: 'tau_c', symbol: 'τ_c', title: 'Coulomb friction', unit: 'Nm',
	empty: null, points: [point('A', 1), point('B', 2, ['beyond_three_sigma'])],
	mean: 1.5, sigma: 0.1, control_limits: [1.2, 1.8], capability: null, quantities: [{ name: 'tau_c', title: 'Coulomb friction' }], pending: 0,
};

it('draws units, those that violate a rule apart, with mean and control limits in one unit', () => {
	const figure = controlFigure(chart, { factor: 1000, unit: 'mNm' });
	expect(figure.series.map(({ label, y }) => [label, ...y])).toEqual([['units', 1000], ['violates a rule', 2000], ['mean 1500 mNm', 1500, 1500], ['control limits (± 3 σ) 1200 mNm and 1800 mNm', 1200, 1200], ['control limits (± 3 σ) 1200 mNm and 1800 mNm', 1800, 1800]]);
	expect(figure.x.names).toEqual(['A', 'B']);
	expect(figure.series[0]!.band).toEqual([[900, 1100]]);
});

it('says what is known of an index', () => {
	expect(indexText(1.2, [0.9, 1.51])).toBe('1.20 [0.900 … 1.51]');
	expect(indexText(1.2, [0.9, null])).toBe('1.20 [0.900 … no upper bound]');
	expect(indexText(null, [2.1, null])).toBe('above 2.10');
	expect(indexText(null, null)).toBe('–');
});

it('says why a chart has no points', () => {
	expect(emptyText({ ...chart, empty: 'no_quantity', quantity: 'tau_x' }, 'Warm-up')).toBe('No complete run of “Warm-up” of these units has the quantity tau_x. Choose another quantity or procedure.');
	expect(emptyText({ ...chart, empty: 'no_run' }, 'Warm-up')).toContain('no result of “Warm-up”');
	expect(emptyText({ ...chart, empty: 'no_run', pending: 2 }, 'Warm-up')).toContain('being computed');
});
