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
/** The palette ends here, in standard errors. */
export const CLIP = 5;

/** Mean in standard errors, clipped; `null` where there are too few points to say. */
export function score(tally: Tally): number | null {
	if (tally.n < ENOUGH || !Number.isFinite(tally.se)) return null;
	if (tally.se === 0) return tally.mean === 0 ? 0 : Math.sign(tally.mean) * CLIP;
	return Math.max(-CLIP, Math.min(CLIP, tally.mean / tally.se));
}
