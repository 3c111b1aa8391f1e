/** Mean residual and its standard error of a group of points. */
export interface BlockMean {
	n: number;
	mean: number;
	/** Standard error of the mean, over blocks of the run if there are enough; infinite for fewer than two points. */
	se: number;
	/** Number of blocks of the run in this group. */
	blocks: number;
}

/** Smallest number of blocks for a standard error over blocks. */
const MIN_BLOCKS = 3;

/** Points of a cell in the order of the run, with the block of each. */
export class BlockSums {
	private n = 0;
	private sum = 0;
	private squares = 0;
	private pieces = 0;
	private piece: number | null = null;
	private within = { n: 0, sum: 0 };
	/** Over the blocks: squared sums, sums times counts, squared counts. */
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

	/** `noise`: known scatter of one point. The standard error of a small group must not be lower than that. */
	mean(noise = 0): BlockMean {
		this.close();
		const { n, pieces } = this;
		if (n === 0) return { n, mean: Number.NaN, se: Number.POSITIVE_INFINITY, blocks: pieces };
		const mean = this.sum / n;
		// A block counts as one observation, independent of its number of points.
		const [ss, sn, nn] = this.over;
		const enough = pieces >= MIN_BLOCKS;
		const spread = enough ? ((ss - 2 * mean * sn + mean * mean * nn) * pieces) / (pieces - 1) : n > 1 ? ((this.squares - n * mean * mean) * n) / (n - 1) : 0;
		const se = Math.max(Math.sqrt(Math.max(0, spread)) / n, noise / Math.sqrt(n));
		return { n, mean, se: n > 1 || noise > 0 ? se : Number.POSITIVE_INFINITY, blocks: pieces };
	}
}

/**
 * Half width of a 95 % band that holds for `together` means simultaneously (Bonferroni); `null` with too few blocks.
 */
export function bandHalfWidth({ se, blocks: pieces }: BlockMean, together: number): number | null {
	return pieces < MIN_BLOCKS ? null : se * quantile(0.05 / Math.max(1, together), pieces - 1);
}

/** Number of cells with a band. */
export const testedCells = (cells: readonly BlockMean[]): number => cells.filter((cell) => score(cell) !== null && cell.blocks >= MIN_BLOCKS).length;

/** The mean is significant, given the number of tested cells. */
export function isSignificant(cell: BlockMean, together: number): boolean {
	const band = score(cell) === null ? null : bandHalfWidth(cell, together);
	return band !== null && Math.abs(cell.mean) > band;
}

const quantiles = new Map<string, number>();

/** Quantile of Student's t for the probability `p` of both tails together. */
export function quantile(p: number, freedom: number): number {
	const key = `${p} ${freedom}`;
	const found = quantiles.get(key);
	if (found !== undefined) return found;
	let [low, high] = [0, 1e4];
	for (let i = 0; i < 60; i++) {
		const middle = (low + high) / 2;
		if (tails(middle, freedom) > p) low = middle;
		else high = middle;
	}
	quantiles.set(key, high);
	return high;
}

/**
 * Probability of Student's t beyond ±t, as the finite series for integer degrees of freedom (Abramowitz and Stegun
 * 26.7.3 and 26.7.4).
 */
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

/** Fewer points than this get no colour. */
export const MIN_POINTS = 10;
/** Score of a cell without scatter, in standard errors. */
const EXACT_SCORE = 10;

/** Mean in standard errors; `null` with too few points. */
export function score(tally: BlockMean): number | null {
	if (tally.n < MIN_POINTS || !Number.isFinite(tally.se)) return null;
	if (tally.se === 0) return tally.mean === 0 ? 0 : Math.sign(tally.mean) * EXACT_SCORE;
	return tally.mean / tally.se;
}
