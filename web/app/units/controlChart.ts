import type { Capability, ControlChart } from '../api/types';
import type { Figure, Series } from '../figure/figure';
import { type Scale, formatNumber, formatQuantity } from '../format/number';

type Rule = ControlChart['points'][number]['violates'][number];

/** The rules of Western Electric, as the daemon names them. */
export const RULES: Record<Rule, string> = {
	beyond_three_sigma: 'beyond 3 σ',
	two_of_three_beyond_two_sigma: '2 of 3 beyond 2 σ on one side',
	four_of_five_beyond_one_sigma: '4 of 5 beyond 1 σ on one side',
	eight_on_one_side: '8 in a row on one side of the mean',
};

/** Largest number of units that can be named along an axis. */
const NAMED = 30;

/** Points with intervals, those that violate a rule apart, mean, control limits and limits of the part. */
export function controlFigure(chart: ControlChart, { factor, unit }: Scale): Figure {
	const { points, mean, control_limits: limits, capability } = chart;
	const named = points.length <= NAMED;
	const of = (label: string, chosen: (violates: boolean) => boolean): Series => {
		const shown = points.map((point, i) => ({ ...point, i })).filter(({ violates }) => chosen(violates.length > 0));
		return { label, mark: 'points', x: shown.map(({ i }) => (named ? i : i + 1)), y: shown.map(({ value }) => value * factor), band: shown.map(({ value, ci95 }) => (ci95 ?? [value, value]).map((end) => end * factor)) };
	};
	const ends = named ? [0, points.length - 1] : [1, points.length];
	/** Lines at the given values, whose label states them. */
	const lines = (label: string, values: readonly (number | null | undefined)[]): Series[] => {
		const heights = values.flatMap((value) => (value == null ? [] : [value * factor]));
		const text = `${label} ${heights.map((y) => formatQuantity(y, unit, 4)).join(' and ')}`;
		return heights.map((y) => ({ label: text, mark: 'line', x: ends, y: [y, y] }));
	};
	const series = [
		of('units', (violates) => !violates),
		of('violates a rule', (violates) => violates),
		...lines('mean', [mean]),
		...lines('control limits (± 3 σ)', limits ?? []),
		...lines('limits of the part', [capability?.lower, capability?.upper]),
	].filter(({ x }) => x.length > 0);
	const x = named ? { label: 'unit', unit: '', names: points.map((point) => point.unit) } : { label: 'unit, in the order of the runs', unit: '' };
	return { name: `chart-${chart.quantity}`, title: chart.title, form: 'cartesian', x, y: { label: chart.title, unit }, series };
}

/** `1.20 [0.90 … 1.51]`, `above 2.1`, or a dash. */
export function indexText(value: number | null | undefined, ci95: Capability['cp_ci95']): string {
	const [low, high] = (ci95 ?? [null, null]) as [number | null, number | null];
	if (value == null) return low === null ? '–' : `above ${formatNumber(low, 3)}`;
	if (low === null) return formatNumber(value, 3);
	return `${formatNumber(value, 3)} [${formatNumber(low, 3)} … ${high === null ? 'no upper bound' : formatNumber(high, 3)}]`;
}

/** Why a chart has no points, and what to choose. */
export function emptyText({ empty, quantity, pending }: ControlChart, procedure: string): string {
	if (pending > 0) return 'The results of the units are being computed.';
	if (empty === 'no_quantity') return `No complete run of “${procedure}” of these units has the quantity ${quantity}. Choose another quantity or procedure.`;
	return `These units have no result of “${procedure}”, apart from reference units. Choose another procedure, or change the search.`;
}
