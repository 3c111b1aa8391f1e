import { labelledTicks } from '../plot/ticks';
import { type Figure, type Series, type Span, reachOf, spanOf } from './figure';

export interface Tick {
	at: number;
	text: string;
}

/** Position of a figure on its paper [px]. */
export interface PlotLayout {
	left: number;
	right: number;
	top: number;
	bottom: number;
	x: (value: number) => number;
	y: (value: number) => number;
	xTicks: Tick[];
	yTicks: Tick[];
	/** Names along x are too long for horizontal text. */
	slanted: boolean;
	/** Width of one bar. */
	bar: number;
}

const LEFT = 62;
const LETTER = 6.1;
/** Slope of slanted names, and the height of each of their letters. */
export const SLANT_DEG = 32;
const DOWN = LETTER * Math.sin((SLANT_DEG * Math.PI) / 180);

export function cartesianLayout(figure: Figure, width: number, height: number, factor: { x: number; y: number }): PlotLayout {
	const names = figure.x.names?.length ? figure.x.names : null;
	const slot = names ? (width - LEFT - 10) / names.length : 0;
	const longest = Math.max(0, ...(names ?? []).map((name) => name.length));
	const slanted = longest * LETTER > slot - 6 && names !== null;
	const [left, right, top, bottom] = [LEFT, width - 10, 8, height - (slanted ? 36 + longest * DOWN : 38)];
	const bars = figure.series.filter((one) => one.mark === 'bars');
	const step = names ? 1 : narrowest(bars);
	const [xLow, xHigh] = names ? [-0.5, names.length - 0.5] : widened(spanOf(figure.series.flatMap((one) => one.x)), bars.length ? step * 0.6 : 0, 0.02);
	const [yLow, yHigh] = withMargin(reachOf(figure.series), bars.length > 0);
	const x = (value: number) => left + ((value - xLow) / (xHigh - xLow)) * (right - left);
	const y = (value: number) => bottom - ((value - yLow) / (yHigh - yLow)) * (bottom - top);
	const scaled = (low: number, high: number, factor: number, count: number, at: (value: number) => number) =>
		labelledTicks(low * factor, high * factor, count).map(({ tick, text }) => ({ at: at(tick / factor), text }));
	return {
		left,
		right,
		top,
		bottom,
		x,
		y,
		xTicks: names ? names.map((text, i) => ({ at: x(i), text })) : scaled(xLow, xHigh, factor.x, Math.max(2, (right - left) / 80), x),
		yTicks: scaled(yLow, yHigh, factor.y, Math.max(2, (bottom - top) / 44), y),
		slanted,
		bar: bars.length ? Math.max(2, Math.min(46, (Math.abs(x(step) - x(0)) * 0.76) / bars.length)) : 0,
	};
}

/** Middle of a title along y: that of its axis, or lower, so that a longer title begins at the top edge. */
export const titleMiddle = (title: string, { top, bottom }: Pick<PlotLayout, 'top' | 'bottom'>): number => Math.max((top + bottom) / 2, (title.length * LETTER) / 2);

/** The smallest distance between two bars of one series. */
function narrowest(bars: readonly Series[]): number {
	let step = Infinity;
	for (const { x } of bars) {
		const sorted = [...x].sort((a, b) => a - b);
		for (let i = 1; i < sorted.length; i++) if (sorted[i]! > sorted[i - 1]!) step = Math.min(step, sorted[i]! - sorted[i - 1]!);
	}
	return Number.isFinite(step) ? step : 1;
}

function widened([low, high]: Span, by: number, share: number): Span {
	const more = by || (high - low) * share || Math.abs(high) * 0.1 || 0.5;
	return [low - more, high + more];
}

/** Margin above and below, except at the zero line of bars. */
function withMargin([low, high]: Span, standing: boolean): Span {
	const more = (high - low) * 0.07 || Math.abs(high) * 0.1 || 1;
	return [standing && low === 0 ? 0 : low - more, standing && high === 0 ? 0 : high + more];
}
