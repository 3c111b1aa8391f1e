/** Mean residual and its standard error of a handful of points. */
export interface Tally {
	n: number;
	mean: number;
	/** Standard error of the mean, over pieces of the run where there are enough; infinite for fewer than two points. */
	se: number;
	/** Pieces of the run that pass through. */
	pieces: number;
}

/** Fewer pieces say nothing about one more. */
const FEWEST = 3;

/** Points of a cell in the order of the run, with the piece of each. */
export class Sums {
	private n = 0;
	private sum = 0;
	private squares = 0;
	private pieces = 0;
	private piece: number | null = null;
	private within = { n: 0, sum: 0 };
	/** Over the pieces: their sums squared, sums times numbers, numbers squared. */
	private over = [0, 0, 0] as [number, number, number];

	add(value: number, piece: number): void {
		if (piece !== this.piece) {
			this.close();
			this.piece = piece;
			this.pieces += 1;
		}
		this.within.n += 1;
		this.within.sum += value;
		this.n += 1;
		this.sum += value;
		this.squares += value * value;
	}

	private close(): void {
		const { n, sum } = this.within;
		this.over = [this.over[0] + sum * sum, this.over[1] + sum * n, this.over[2] + n * n];
		this.within = { n: 0, sum: 0 };
	}

	/** `noise`: scatter of one point that is known from elsewhere; a lucky handful must not look surer than that. */
	tally(noise = 0): Tally {
		this.close();
		const { n, pieces } = this;
		if (n === 0) return { n, mean: Number.NaN, se: Number.POSITIVE_INFINITY, pieces };
		const mean = this.sum / n;
		// What a piece has in common is one piece of evidence, however many points it has.
		const [ss, sn, nn] = this.over;
		const enough = pieces >= FEWEST;
		const spread = enough ? ((ss - 2 * mean * sn + mean * mean * nn) * pieces) / (pieces - 1) : n > 1 ? ((this.squares - n * mean * mean) * n) / (n - 1) : 0;
		const se = Math.max(Math.sqrt(Math.max(0, spread)) / n, noise / Math.sqrt(n));
		return { n, mean, se: n > 1 || noise > 0 ? se : Number.POSITIVE_INFINITY, pieces };
	}
}

/** Half of a 95 % band that holds for so many means together (Bonferroni); `null` where too few pieces tell of it. */
export function half({ se, pieces }: Tally, together: number): number | null {
	return pieces < FEWEST ? null : se * quantile(0.05 / Math.max(1, together), pieces - 1);
}

/** Cells that a band is told of. */
export const judged = (cells: readonly Tally[]): number => cells.filter((cell) => score(cell) !== null && cell.pieces >= FEWEST).length;

/** The mean is no accident, with as many cells as are judged. */
export function beyond(cell: Tally, together: number): boolean {
	const band = score(cell) === null ? null : half(cell, together);
	return band !== null && Math.abs(cell.mean) > band;
}

const known = new Map<string, number>();

/** Student's t beyond which lies the share `p` of both tails. */
export function quantile(p: number, freedom: number): number {
	const key = `${p} ${freedom}`;
	const found = known.get(key);
	if (found !== undefined) return found;
	let [low, high] = [0, 1e4];
	for (let i = 0; i < 60; i++) {
		const middle = (low + high) / 2;
		if (tails(middle, freedom) > p) low = middle;
		else high = middle;
	}
	known.set(key, high);
	return high;
}

/** Share of Student's t beyond ±t, as the finite series for whole degrees of freedom (Abramowitz and Stegun 26.7.3 and 26.7.4). */
function tails(t: number, freedom: number): number {
	const angle = Math.atan(t / Math.sqrt(freedom));
	const [sin, cos] = [Math.sin(angle), Math.cos(angle)];
	const odd = freedom % 2;
	let term = odd ? cos : 1;
	let sum = freedom > 1 ? term : 0;
	for (let k = 2 + odd; k < freedom; k += 2) {
		term *= (cos * cos * (k - 1)) / k;
		sum += term;
	}
	return 1 - (odd ? (2 / Math.PI) * (angle + sin * sum) : sin * sum);
}

/** Fewer points than this show no colour. */
export const ENOUGH = 10;
/** Of a cell without any scatter: as far from zero as a plain one can be, in standard errors. */
const EXACT = 10;

/** Mean in standard errors; `null` where there are too few points to say. */
export function score(tally: Tally): number | null {
	if (tally.n < ENOUGH || !Number.isFinite(tally.se)) return null;
	if (tally.se === 0) return tally.mean === 0 ? 0 : Math.sign(tally.mean) * EXACT;
	return tally.mean / tally.se;
}
