import type { IdentifiedQuantity } from '../api/types';

/** What the samples so far say, at one moment of the run. */
export interface Said {
	at_s: number;
	quantities: readonly IdentifiedQuantity[];
}

/** How the interval of a quantity has gone: lower and upper end in shares of the height, 0 at the top. */
export interface Funnel {
	x: number;
	low: number;
	high: number;
}

/**
 * The intervals of one quantity over the run so far, on a scale that shows the second half of them whole: the first are as wide as
 * the page.
 */
export function funnel(story: readonly Said[], name: string): Funnel[] {
	const points = story.flatMap(({ at_s, quantities }) => {
		const ends = quantities.find((one) => one.name === name)?.ci95;
		return ends && ends[0] != null && ends[1] != null ? [{ at_s, low: ends[0], high: ends[1] }] : [];
	});
	const late = points.slice(Math.floor(points.length / 2));
	const [low, high] = [Math.min(...late.map((one) => one.low)), Math.max(...late.map((one) => one.high))];
	const [first, last] = [points[0]?.at_s ?? 0, points.at(-1)?.at_s ?? 1];
	const span = (high - low) * 1.3 || 1;
	const place = (value: number) => Math.max(0, Math.min(1, 0.5 - (value - (low + high) / 2) / span));
	return points.map((one) => ({ x: last > first ? (one.at_s - first) / (last - first) : 1, low: place(one.low), high: place(one.high) }));
}
