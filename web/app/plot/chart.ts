import uPlot from 'uplot';
import { spanOf } from '../figure/figure';
import type { HoverPlace } from '../ui/hoverPlace';
import { EMPTY_BACKDROP, type Backdrop, paintBackdrop, paintLimitNames } from './backdrop';
import { colour } from './colour';
import { type OnView, type View, gestures } from './gestures';
import { dashPaths, pointPaths } from './markPaths';
import { type Cursors, type OnCursors, cursorLines } from './cursors';
import { powerText, tickTexts } from './ticks';
import { linePaths } from './linePaths';

/** `line` joins the points, `chord` only the first and the last; the others mark each point separately. */
export type Mark = 'line' | 'chord' | 'dot' | 'ring' | 'dash';

export interface Curve {
	label: string;
	unit: string;
	mark: Mark;
	/** Custom property of the colour. */
	stroke: string;
	dash?: number[];
	/** Half height of the band around a `chord`, or of the box around a `dash`: the scatter of repeats. */
	spread?: number;
	/** Its marks are shifted to the right, so that they do not cover others. */
	offset?: boolean;
}

const OFFSET_PX = 5;

export interface ChartLayout {
	xTitle: string;
	yTitle: string;
	curves: Curve[];
	/** Plots with the same key share a cursor. */
	sync?: string;
	height: number;
	/** The axis below has the labels. */
	hideXLabels?: boolean;
	/** The plots above have the same cursors. */
	cursorsAbove?: boolean;
	/** There is a band around zero, which is always in view. */
	banded?: boolean;
	/** Both axes have the same range. */
	square?: boolean;
	/** The values are exponents of ten: the axis shows the powers. */
	log?: boolean;
}

/** The sample under the pointer. */
export interface Pointed {
	index: number;
	place: HoverPlace;
}

export interface Chart {
	draw: (data: uPlot.AlignedData, view: View | null, backdrop: Backdrop) => void;
	/** Ranges of the axes. */
	axisRanges: () => { x: View; y: View };
	/** Two cursors for measuring, or none. */
	measure: (cursors: Cursors | null) => void;
	resize: (width: number, height: number) => void;
	destroy: () => void;
}

/**
 * The only module that uses uPlot. The zoom is controlled here, and data never changes it (uPlot issues 505 and 942).
 */
export function makeChart(
	host: HTMLElement,
	frame: ChartLayout,
	onview: OnView,
	pointed: (point: Pointed | null) => void,
	moved: OnCursors = () => {},
): Chart {
	let view: View | null = null;
	let backdrop = EMPTY_BACKDROP;
	let whole: View = [0, 1];
	let lines: ReturnType<typeof cursorLines> | null = null;
	const gestureOptions = gestures(onview);
	/** Points at the ends are drawn completely. */
	const marked = frame.curves.some(({ mark }) => mark !== 'line');
	const plot = new uPlot(
		{
			width: Math.max(80, host.clientWidth),
			height: frame.height,
			legend: { show: false },
			padding: [8, 10, 0, 0],
			scales: {
				x: { time: false, range: (_u, low, high) => view ?? (frame.square ? whole : padded(low, high, marked ? 0.012 : 0)) },
				y: frame.square ? { range: () => view ?? whole } : frame.banded ? { range: (_u, low, high) => withBand(low, high, backdrop.band ?? 0) } : {},
			},
			axes: [axis(frame.hideXLabels ? '' : frame.xTitle, tickTexts, frame.hideXLabels), axis(frame.yTitle, frame.log ? (powers) => powers.map(powerText) : tickTexts, false, 58)],
			series: [{}, ...frame.curves.map((curve) => series(curve, () => backdrop))],
			cursor: {
				...gestureOptions.cursor,
				points: { size: 6 },
				y: false,
				sync: frame.sync ? { key: frame.sync, setSeries: false, scales: ['x', null], filters: { pub: (what) => what === 'mousemove' } } : undefined,
			},
			hooks: {
				...gestureOptions.hooks,
				draw: [(u) => paintLimitNames(u, backdrop), () => lines?.place()],
				drawAxes: [(u) => paintBackdrop(u, backdrop)],
				setCursor: [(u) => pointed(pointedSample(u))],
			},
		},
		[[], ...frame.curves.map(() => [])] as unknown as uPlot.AlignedData,
		host,
	);
	plot.root.role = 'group';
	plot.root.ariaLabel = `${frame.yTitle} over ${frame.xTitle}`;
	lines = cursorLines(plot, frame.xTitle, moved, !frame.cursorsAbove);
	return {
		draw: (data, next, behind) => {
			view = next;
			backdrop = behind;
			if (frame.square) whole = padded(...spanOf(data.flatMap((one) => [...one] as number[])), 0.02);
			plot.setData(data, true);
		},
		axisRanges: () => ({ x: shown(plot.scales.x), y: shown(plot.scales.y) }),
		measure: (cursors) => lines?.put(cursors),
		resize: (width, height) => plot.setSize({ width, height }),
		destroy: () => plot.destroy(),
	};
}

function pointedSample({ cursor: { idx, left, top }, over, width, height }: uPlot): Pointed | null {
	if (idx == null) return null;
	return { index: idx, place: { at: [over.offsetLeft + left!, over.offsetTop + top!], size: [width, height] } };
}

const shown = (scale: uPlot.Scale | undefined): View => [scale?.min ?? 0, scale?.max ?? 1];

function padded(low: number, high: number, share = 0): View {
	if (low == null || high == null) return [0, 1];
	const more = low === high ? 0.5 : (high - low) * share;
	return [low - more, high + more];
}

function withBand(low: number | null, high: number | null, band: number): View {
	const [from, to] = [Math.min(low ?? 0, -band), Math.max(high ?? 0, band)];
	return padded(from - 0.1 * (to - from), to + 0.1 * (to - from));
}

function axis(title: string, say: (ticks: readonly number[]) => string[], bare = false, size?: number): uPlot.Axis {
	return {
		label: title || undefined,
		labelSize: title ? 18 : 0,
		labelFont: '11px system-ui, sans-serif',
		labelGap: 2,
		font: '11px system-ui, sans-serif',
		stroke: () => colour('--soft'),
		grid: { stroke: () => colour('--hair'), width: 1 },
		ticks: { stroke: () => colour('--line'), width: 1, size: 4 },
		gap: 4,
		size: bare ? 8 : (size ?? 28),
		space: size ? 24 : 60,
		values: (_u, splits) => (bare ? splits.map(() => '') : say(splits)),
	};
}

function series(curve: Curve, backdrop: () => Backdrop): uPlot.Series {
	const stroke = () => colour(curve.stroke);
	const offset = () => (curve.offset ? OFFSET_PX * devicePixelRatio : 0);
	const fill = () => `color-mix(in srgb, ${stroke()} ${curve.mark === 'line' ? 45 : 22}%, transparent)`;
	if (curve.mark === 'line') return { stroke, fill, points: { show: false }, paths: linePaths(curve.dash, () => backdrop().gaps) };
	if (curve.mark === 'chord') return { stroke, width: 1.5, dash: curve.dash, points: { show: false }, fill, paths: (u, i) => chord(u, i, curve.spread ?? 0) };
	if (curve.mark === 'dash') {
		const paths: uPlot.Series.PathBuilder = (u, i, from, to) => dashPaths(u, i, from, to, curve.spread ?? 0, offset());
		return { stroke, width: 2, points: { show: false }, paths, fill };
	}
	const filled = curve.mark === 'dot';
	return { stroke, width: 1, fill: stroke, points: { show: false }, paths: (u, i, from, to) => pointPaths(u, i, from, to, filled, offset()) };
}

function chord(u: uPlot, index: number, spread: number): uPlot.Series.Paths {
	const [xs, ys] = [u.data[0]!, u.data[index]!];
	const last = xs.length - 1;
	const joined = (corners: [i: number, above: number][]) =>
		corners.reduce((path, [i, above]) => (path.lineTo(u.valToPos(xs[i] ?? 0, 'x', true), u.valToPos((ys[i] ?? 0) + above, 'y', true)), path), new Path2D());
	return { stroke: joined([[0, 0], [last, 0]]), fill: joined([[0, spread], [last, spread], [last, -spread], [0, -spread]]) };
}
