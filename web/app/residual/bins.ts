/**
 * Where to cut an axis. Measurements taken at set points fall into clusters: one bin each, with the borders halfway
 * between. Anything else is cut into equal widths.
 */
export interface Bins {
	edges: number[];
	/** True where the bins are set points. */
	levels: boolean;
}

const MAX_LEVELS = 40;

export function binsFor(values: readonly number[], most = 24): Bins {
	const sorted = values.filter(Number.isFinite).sort((a, b) => a - b);
	const low = sorted[0];
	const high = sorted.at(-1);
	if (low === undefined || high === undefined) return { edges: [], levels: false };
	if (high === low) return { edges: [low - 0.5, high + 0.5], levels: true };
	return clusters(sorted, high - low) ?? { edges: equal(low, high, bandCount(sorted.length, most)), levels: false };
}

/** Enough bins to see a shape, few enough that each holds ten points. */
function bandCount(points: number, most: number): number {
	return Math.max(3, Math.min(most, Math.floor(points / 12)));
}

function equal(low: number, high: number, count: number): number[] {
	return Array.from({ length: count + 1 }, (_, i) => low + ((high - low) * i) / count);
}

function clusters(sorted: readonly number[], span: number): Bins | null {
	const edges = [sorted[0]! - span * 1e-3];
	let begin = sorted[0]!;
	for (let i = 1; i < sorted.length; i++) {
		const [before, here] = [sorted[i - 1]!, sorted[i]!];
		if (here - before <= 0.012 * span) continue;
		if (before - begin > 0.05 * span || edges.length > MAX_LEVELS) return null;
		edges.push((before + here) / 2);
		begin = here;
	}
	const last = sorted.at(-1)!;
	if (last - begin > 0.05 * span || edges.length < 2) return null;
	if (sorted.length < 2 * edges.length) return null;
	edges.push(last + span * 1e-3);
	return { edges, levels: true };
}

/** Index of the bin that holds the value, −1 outside. The last edge belongs to the last bin. */
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
