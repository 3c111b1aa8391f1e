/** Mean residual and its standard error of a handful of points. */
export interface Tally {
	n: number;
	mean: number;
	/** Standard error of the mean; infinite for fewer than two points. */
	se: number;
}

export class Sums {
	private n = 0;
	private sum = 0;
	private squares = 0;

	add(value: number): void {
		this.n += 1;
		this.sum += value;
		this.squares += value * value;
	}

	/** `noise`: scatter of one point that is known from elsewhere; a lucky handful must not look surer than that. */
	tally(noise = 0): Tally {
		const { n } = this;
		if (n === 0) return { n, mean: Number.NaN, se: Number.POSITIVE_INFINITY };
		const mean = this.sum / n;
		const variance = n > 1 ? Math.max(0, (this.squares - n * mean * mean) / (n - 1)) : 0;
		const scatter = Math.max(Math.sqrt(variance), noise);
		return { n, mean, se: n > 1 || noise > 0 ? scatter / Math.sqrt(n) : Number.POSITIVE_INFINITY };
	}
}

/** Fewer points than this show no colour. */
export const ENOUGH = 10;
/** Standard errors at which the colour is full; beyond, it only deepens. */
export const CLIP = 5;
/** Standard errors at which it is deepest, at least; a map that is further off goes on to its worst cell. */
export const DEEP = 10;

/** Mean in standard errors; `null` where there are too few points to say. */
export function score(tally: Tally): number | null {
	if (tally.n < ENOUGH || !Number.isFinite(tally.se)) return null;
	if (tally.se === 0) return tally.mean === 0 ? 0 : Math.sign(tally.mean) * DEEP;
	return tally.mean / tally.se;
}

/** The end of the palette for these cells. */
export function deepest(cells: readonly Tally[]): number {
	return cells.reduce((most, cell) => Math.max(most, Math.abs(score(cell) ?? 0)), DEEP);
}

/** How deep the colour is: −1 to 1 up to the clip, on to ±2 beyond it in equal ratios, so that a hundred cells past the clip still differ. */
export function depth(z: number, deep: number): number {
	const size = Math.abs(z);
	const beyond = size > CLIP ? Math.min(1, Math.log(size / CLIP) / Math.log(deep / CLIP)) : 0;
	return Math.sign(z) * (Math.min(1, size / CLIP) + beyond);
}
