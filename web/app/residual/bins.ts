import { detectSetPoints } from './setPoints';

/** Bin edges of an axis. */
export interface Bins {
	edges: number[];
	/**
	 * Values of the bins, if the bins are the set-points of the run. Set-points have equal widths in the drawing,
	 * because they are dense at low speeds. On a linear axis those would be too narrow.
	 */
	setPoints: number[] | null;
	/** Factor from the stored unit to the displayed unit, such as rad/s to rpm. */
	factor?: number;
}

/** Smallest number of points per bin. */
const POINTS_PER_BIN = 12;

/** `segment`: number of the set-point of each value. Values that are not finite are ignored. */
export function binsFor(values: readonly number[], segment: readonly number[], counted: Uint8Array, most = 24): Bins {
	const points: { value: number; segment: number }[] = [];
	let low = Number.POSITIVE_INFINITY;
	let high = Number.NEGATIVE_INFINITY;
	for (let i = 0; i < values.length; i++) {
		const value = values[i]!;
		if (!counted[i] || !Number.isFinite(value)) continue;
		points.push({ value, segment: segment[i] ?? 0 });
		low = Math.min(low, value);
		high = Math.max(high, value);
	}
	if (points.length === 0 || high === low) return { edges: [], setPoints: null };
	const setPoints = detectSetPoints(points, high - low);
	if (setPoints) {
		const middles = setPoints.slice(1).map((level, i) => (setPoints[i]! + level) / 2);
		return { edges: [low, ...middles, high], setPoints };
	}
	const count = Math.max(3, Math.min(most, Math.floor(points.length / POINTS_PER_BIN)));
	return { edges: Array.from({ length: count + 1 }, (_, i) => low + ((high - low) * i) / count), setPoints: null };
}

/** Index of the bin that contains the value, −1 outside. The last edge belongs to the last bin. */
export function binOf(edges: readonly number[], value: number): number {
	const last = edges.length - 1;
	if (last < 1 || !(value >= edges[0]! && value <= edges[last]!)) return -1;
	let low = 0;
	let high = last;
	while (high - low > 1) {
		const middle = (low + high) >> 1;
		if (value >= edges[middle]!) low = middle;
		else high = middle;
	}
	return low;
}

/** Extends a range to the bins whose middles it contains; if there are none, to the bin that contains it. */
export function wholeBins({ edges, setPoints: levels }: Bins, stretch: readonly [number, number] | null): [number, number] | null {
	if (!stretch || edges.length < 2) return null;
	const [from, to] = stretch;
	const middles = levels ?? edges.slice(1).map((edge, i) => (edges[i]! + edge) / 2);
	const first = middles.findIndex((middle) => middle >= from && middle <= to);
	const last = middles.findLastIndex((middle) => middle >= from && middle <= to);
	if (first >= 0) return [edges[first]!, edges[last + 1]!];
	const inside = binOf(edges, Math.max(edges[0]!, Math.min(edges.at(-1)!, (from + to) / 2)));
	return [edges[inside]!, edges[inside + 1]!];
}
