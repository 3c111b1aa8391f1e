import type { IdentifiedQuantity } from '../api/types';

/** Preliminary results at one time of the run. */
export interface EstimateSnapshot {
	at_s: number;
	quantities: readonly IdentifiedQuantity[];
}

/** Growth of an interval that is reported. */
const WIDER = 1.5;
const width = ({ ci95 }: IdentifiedQuantity) => ci95![1]! - ci95![0]!;

/** The last change of the identified quantities, with its time: a quantity was added, lost, or became less certain. */
export function lastChange(story: readonly EstimateSnapshot[]): string | null {
	const known = story.map(({ quantities }) => quantities.filter((one) => one.ci95));
	for (let i = story.length - 1; i > 0 && known[i - 1]!.length > 0; i--) {
		const [before, now] = [known[i - 1]!, known[i]!];
		const only = (here: readonly IdentifiedQuantity[], there: readonly IdentifiedQuantity[]) => here.filter(({ name }) => there.every((one) => one.name !== name)).map(({ title }) => title).join(', ');
		const [added, removed] = [only(now, before), only(before, now)];
		const wider = now.filter((one) => before.some((other) => other.name === one.name && width(one) > WIDER * width(other))).length;
		const changes = [added && `found now: ${added}`, removed && `no longer found: ${removed}`, wider && `${wider} of ${now.length} intervals wider`].filter(Boolean).join('; ');
		if (changes) return `From ${story[i]!.at_s.toFixed(0)} s on ${changes}. Intervals grow with each further effect, and where new samples contradict earlier ones.`;
	}
	return null;
}

/** The interval of a quantity over time: lower and upper end as fractions of the height, 0 at the top. */
export interface IntervalPoint {
	x: number;
	low: number;
	high: number;
}

/**
 * The intervals of one quantity over the run so far. The scale fits their second half, because the first intervals are
 * very wide.
 */
export function intervalHistory(story: readonly EstimateSnapshot[], name: string): IntervalPoint[] {
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
