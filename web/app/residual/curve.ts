import { binOf } from './bins';
import { BlockSums, type BlockMean } from './blockMeans';

export interface Point extends BlockMean {
	from: number;
	to: number;
}

/** Mean residual along one axis. */
export function curve(values: readonly number[], edges: number[], residual: readonly number[], counted: Uint8Array, noise: number, piece: readonly number[]): Point[] {
	const sums = edges.slice(1).map(() => new BlockSums());
	for (let i = 0; i < residual.length; i++) {
		if (counted[i]) sums[binOf(edges, values[i]!)]?.add(residual[i]!, piece[i]!);
	}
	return sums.map((s, i) => ({ ...s.mean(noise), from: edges[i]!, to: edges[i + 1]! }));
}

/**
 * Fraction of the residual's variance that depends on the axis: ω² of a one-way analysis of variance, which does not
 * favour axes with many bins (Hays 1963).
 */
export function explainedShare(values: readonly number[], edges: number[], residual: readonly number[], counted: Uint8Array): number {
	const groups = new Map<number, { n: number; sum: number }>();
	let n = 0;
	let sum = 0;
	let squares = 0;
	for (let i = 0; i < residual.length; i++) {
		const bin = counted[i] ? binOf(edges, values[i]!) : -1;
		if (bin < 0) continue;
		const group = groups.get(bin) ?? { n: 0, sum: 0 };
		const r = residual[i]!;
		groups.set(bin, { n: group.n + 1, sum: group.sum + r });
		n += 1;
		sum += r;
		squares += r * r;
	}
	const k = groups.size;
	if (k < 2 || n <= k) return 0;
	const total = squares - (sum * sum) / n;
	let between = -(sum * sum) / n;
	for (const group of groups.values()) between += (group.sum * group.sum) / group.n;
	const within = (total - between) / (n - k);
	const share = (between - (k - 1) * within) / (total + within);
	return Number.isFinite(share) ? Math.max(0, Math.min(1, share)) : 0;
}
