/** [s] */
const INTERVAL_S = 0.2;

/** Means of a difference over short time intervals, each at its middle; rows without both values are ignored. */
export function shortMeans(time: ArrayLike<number | null>, first: ArrayLike<number | null>, second: ArrayLike<number | null>): [number, number][] {
	const sums = new Map<number, [n: number, sum: number]>();
	for (let i = 0; i < time.length; i++) {
		const difference = (first[i] ?? NaN) - (second[i] ?? NaN);
		if (Number.isNaN(difference)) continue;
		const at = Math.floor(time[i]! / INTERVAL_S);
		const [n, sum] = sums.get(at) ?? [0, 0];
		sums.set(at, [n + 1, sum + difference]);
	}
	return [...sums].map(([at, [n, sum]]) => [(at + 0.5) * INTERVAL_S, sum / n]);
}
