import type { SeriesRole, Table } from '../api/types';

/**
 * A plot as the daemon describes it, in SI units: its data and the styles of its series. Its geometry is in `cartesian`
 * and `polar`.
 */
export interface Axis {
	label: string;
	unit: string;
	/** Names of the positions on an axis of named things: position 0 has the first name. */
	names?: string[];
}

export interface Series {
	label: string;
	/** Series of one group have one colour; without a group, those of one label. */
	group?: string | null;
	/** Meaning of the series for its figure. */
	role?: SeriesRole | null;
	mark: 'points' | 'line' | 'bars';
	x: number[];
	y: number[];
	/** Lower and upper end at each point, or empty. */
	band?: number[][];
}

export interface Figure {
	name: string;
	title: string;
	form: 'cartesian' | 'polar';
	x: Axis;
	y: Axis;
	series: Series[];
}

export interface Style {
	/** Custom property of the colour. */
	stroke: string;
	/** Dash of a line. */
	dash: string;
	/** Glyph of points. */
	glyph: Glyph;
	/** Position among the bars of the figure. */
	bar: number;
}

export type Glyph = 'dot' | 'ring' | 'square' | 'cross' | 'triangle';

/**
 * The seven colours of Okabe & Ito; six dashes and five glyphs, so that a repeated colour has another dash or glyph.
 */
const STROKES = ['--oi-blue', '--oi-vermillion', '--oi-green', '--oi-purple', '--oi-orange', '--oi-sky', '--oi-black'];
const DASHES = ['', '7 4', '2 3', '9 3 2 3', '4 2', '14 3'];
const GLYPHS: Glyph[] = ['dot', 'ring', 'square', 'cross', 'triangle'];

/** `runs`: runs in the order in which another plot assigns its colours and dashes. */
export function styles(series: readonly Series[], runs: readonly string[] = []): Style[] {
	const labels = series.map((one) => one.label);
	const groups = series.map((one) => one.group ?? one.label);
	const families = [...new Set([...runs, ...groups])];
	/** Position among the series with the same mark. Series with the same name look the same. */
	const before = (i: number) => [...new Set(series.filter((one) => one.mark === series[i]!.mark).map((one) => one.label))].indexOf(labels[i]!);
	/** The second curve of a run has a dash that no first curve has. */
	const dash = (i: number) => (runs.length ? families.indexOf(groups[i]!) + runs.length * groups.slice(0, i).filter((one) => one === groups[i]).length : before(i));
	return series.map((_, i) => ({
		stroke: STROKES[families.indexOf(groups[i]!) % STROKES.length]!,
		dash: DASHES[dash(i) % DASHES.length]!,
		glyph: GLYPHS[before(i) % GLYPHS.length]!,
		bar: before(i),
	}));
}

/** The figure with each axis in the displayed unit. */
export function inDisplayUnits(figure: Figure, scaleOf: (unit: string) => { factor: number; unit: string }): Figure {
	const [x, y] = [scaleOf(figure.x.unit), scaleOf(figure.y.unit)];
	if (x.factor === 1 && y.factor === 1) return figure;
	const series = figure.series.map((one) => ({
		...one,
		x: one.x.map((value) => value * x.factor),
		y: one.y.map((value) => value * y.factor),
		band: one.band?.map((ends) => ends.map((end) => end * y.factor)),
	}));
	return { ...figure, x: { ...figure.x, unit: x.unit }, y: { ...figure.y, unit: y.unit }, series };
}

/** The axis along which the errors before and after compensation are compared. */
const comparedAxis = ({ series, x }: Figure) => (!x.names && series.some((one) => one.mark === 'bars') ? 'x' : 'y');

function magnificationOf(figure: Figure): number {
	const largest = (role: SeriesRole) => Math.max(...figure.series.filter((one) => one.role === role).flatMap((one) => one[comparedAxis(figure)].map(Math.abs)));
	const ratio = largest('before') / largest('after');
	const power = 10 ** Math.floor(Math.log10(ratio));
	const factor = power * (ratio < 2 * power ? 1 : ratio < 5 * power ? 2 : 5);
	return factor >= 5 && factor < Infinity ? factor : 1;
}

/**
 * A small remainder compared with its original value would be a flat line or a single bar. It is magnified by this
 * factor in all figures that have room for it.
 */
export const magnification = (figures: readonly Figure[]) => Math.min(...figures.map(magnificationOf).filter((factor) => factor > 1));

/** The figure with the error after compensation magnified by `factor`. A reference line of bars is drawn for both errors. */
export function magnified(figure: Figure, factor: number): Figure {
	if (magnificationOf(figure) < factor) return figure;
	const along = comparedAxis(figure);
	const large = (one: Series): Series => ({
		...one,
		label: `${one.label}, ×${factor}`,
		group: one.group ?? one.label,
		[along]: one[along].map((value) => value * factor),
		band: along === 'y' ? one.band?.map((ends) => ends.map((end) => end * factor)) : one.band,
	});
	const after = figure.series.find(({ role }) => role === 'after');
	const both = figure.x.names ? figure.series.filter(({ mark }) => mark === 'line').map((one) => ({ ...one, group: after?.group ?? after?.label })) : [];
	return { ...figure, series: [...figure.series.map((one) => (one.role === 'after' ? large(one) : one)), ...both.map(large)] };
}

export type Span = readonly [low: number, high: number];

/** From the smallest to the largest number; `[0, 1]` without numbers. */
export function spanOf(values: Iterable<number>): Span {
	let [low, high] = [Infinity, -Infinity];
	for (const value of values) {
		if (!Number.isFinite(value)) continue;
		low = Math.min(low, value);
		high = Math.max(high, value);
	}
	return low <= high ? [low, high] : [0, 1];
}

/** Range of the y axis: bars start at zero. */
export function reachOf(series: readonly Series[]): Span {
	const ends = series.flatMap((one) => [...one.y, ...(one.band ?? []).flat()]);
	return spanOf(series.some((one) => one.mark === 'bars') ? [0, ...ends] : ends);
}

const withUnit = (label: string, unit: string) => (unit ? `${label} [${unit}]` : label);
export const axisName = (axis: Axis) => withUnit(axis.label, axis.unit);

/** The displayed data, one row per point. */
export function tableOf(figure: Figure): Table {
	const y = axisName(figure.y);
	return {
		head: ['series', axisName(figure.x), y, `${y}, lower`, `${y}, upper`],
		rows: figure.series.flatMap(({ label, x, y, band }) => x.map((at, i) => [label, figure.x.names?.[at] ?? at, y[i]!, band?.[i]?.[0] ?? null, band?.[i]?.[1] ?? null])),
	};
}
