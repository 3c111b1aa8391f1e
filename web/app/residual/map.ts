import { type Bins, binOf } from './bins';
import { BlockSums, type BlockMean } from './blockMeans';

export interface ResidualMap {
	x: Bins;
	y: Bins;
	/** Row by row from the smallest y. */
	cells: BlockMean[];
}

/** Mean residual in every cell of two axes. */
export function residualMap(
	x: { values: readonly number[]; bins: Bins },
	y: { values: readonly number[]; bins: Bins },
	residual: readonly number[],
	counted: Uint8Array,
	noise: number,
	piece: readonly number[],
): ResidualMap {
	const columns = Math.max(0, x.bins.edges.length - 1);
	const rows = Math.max(0, y.bins.edges.length - 1);
	const sums = Array.from({ length: columns * rows }, () => new BlockSums());
	for (let i = 0; i < residual.length; i++) {
		if (!counted[i]) continue;
		const column = binOf(x.bins.edges, x.values[i]!);
		const row = binOf(y.bins.edges, y.values[i]!);
		if (column >= 0 && row >= 0) sums[row * columns + column]!.add(residual[i]!, piece[i]!);
	}
	return { x: x.bins, y: y.bins, cells: sums.map((s) => s.mean(noise)) };
}

/** Indices of the cells that contain a selected sample. */
export function cellsOf({ x, y }: ResidualMap, xs: readonly number[], ys: readonly number[], chosen: Uint8Array): Set<number> {
	const columns = x.edges.length - 1;
	const cells = new Set<number>();
	for (let i = 0; i < chosen.length; i++) {
		if (!chosen[i]) continue;
		const column = binOf(x.edges, xs[i]!);
		const row = binOf(y.edges, ys[i]!);
		if (column >= 0 && row >= 0) cells.add(row * columns + column);
	}
	return cells;
}
