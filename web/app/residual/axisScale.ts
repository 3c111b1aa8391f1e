import { tickText, ticks } from '../plot/ticks';
import { type Bins, binOf } from './bins';

/** Converts a value to its pixel position, and back. Set-points have equal widths; other axes are linear. */
export interface AxisScale {
	at: (value: number) => number;
	value: (px: number) => number;
	ticks: number[];
	/** A tick as text. */
	text: (tick: number) => string;
}

export function axisScale({ edges, setPoints: levels, factor = 1 }: Bins, from: number, to: number, count: number): AxisScale {
	const low = edges[0] ?? 0;
	const high = edges.at(-1) ?? 1;
	if (!levels) {
		const span = high - low || 1;
		return {
			at: (value) => from + ((value - low) / span) * (to - from),
			value: (px) => low + ((px - from) / (to - from)) * span,
			ticks: ticks(low * factor, high * factor, count).map((tick) => tick / factor),
			text: (tick) => tickText(tick * factor),
		};
	}
	const n = levels.length;
	const decimals = Math.max(0, Math.min(9, 2 - Math.floor(Math.log10(factor * Math.max(Math.abs(low), Math.abs(high))))));
	const each = Math.max(1, Math.ceil(n / count));
	return {
		at: (value) => {
			const bin = binOf(edges, Math.max(low, Math.min(high, value)));
			const share = (value - edges[bin]!) / (edges[bin + 1]! - edges[bin]! || 1);
			return from + ((bin + Math.max(0, Math.min(1, share))) / n) * (to - from);
		},
		value: (px) => {
			const place = ((px - from) / (to - from)) * n;
			const bin = Math.max(0, Math.min(n - 1, Math.floor(place)));
			return edges[bin]! + (place - bin) * (edges[bin + 1]! - edges[bin]!);
		},
		ticks: levels.filter((_, i) => i % each === Math.floor(((n - 1) % each) / 2)),
		// Set-points are measured values. More digits than three of the largest one do not help to identify them.
		text: (tick) => tickText(Number((tick * factor).toFixed(decimals)) || 0),
	};
}

/** Position of a bin's value: a set-point is in the middle of its column. */
export function binMiddle({ edges, setPoints: levels }: Bins, scale: AxisScale, bin: number): number {
	return levels ? (scale.at(edges[bin]!) + scale.at(edges[bin + 1]!)) / 2 : scale.at((edges[bin]! + edges[bin + 1]!) / 2);
}
