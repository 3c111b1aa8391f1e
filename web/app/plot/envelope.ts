import type { Samples } from '../api/types';

export interface Envelope {
	time: number[];
	columns: (number | null)[][];
	gaps: [number, number][];
}

/**
 * The daemon's minimum and maximum of each pixel as one line. Both have the same time, so that a spike of one sample
 * stays visible. A pause much longer than the others is a gap.
 */
export function envelope(samples: Samples): Envelope {
	const gaps = findGaps(samples.time_s);
	if (samples.exact) return { time: samples.time_s, columns: samples.channels.map((c) => c.min), gaps };
	const time = samples.time_s.flatMap((t) => [t, t]);
	const columns = samples.channels.map((c) => c.min.flatMap((low, i) => [low, c.max[i] ?? low]));
	return { time, columns, gaps };
}

export function findGaps(time_s: readonly number[]): [number, number][] {
	if (time_s.length < 8) return [];
	const steps = time_s.slice(1).map((t, i) => t - time_s[i]!);
	const typical = [...steps].sort((a, b) => a - b)[Math.floor(steps.length * 0.9)]!;
	return steps.flatMap((step, i) => (step > 5 * typical ? [[time_s[i]!, time_s[i + 1]!] as [number, number]] : []));
}

/** Joins earlier and later columns. In the overlap the later columns are used. */
export function joinColumns(early: readonly (readonly (number | null)[])[], late: readonly ArrayLike<number | null>[]): ArrayLike<number | null>[] {
	const begins = late[0]?.[0] ?? Infinity;
	const count = early[0]!.filter((at) => at! < begins).length;
	return late.map((column, c) => {
		// Missing values at the start are null, because a scale cannot start with NaN.
		if (!early[c]?.length) return [...Array<null>(count).fill(null), ...Array.from(column)];
		const both = new Float64Array(count + column.length).fill(Number.NaN);
		for (let i = 0; i < count; i++) both[i] = early[c]?.[i] ?? Number.NaN;
		both.set(column as ArrayLike<number>, count);
		return both;
	});
}
