import { binOf } from './bins';
import { Sums, type Tally } from './tally';

export interface ResidualMap {
	x: number[];
	y: number[];
	/** Row by row from the smallest y. */
	cells: Tally[];
}

/** Mean residual in every cell of two axes. */
export function residualMap(
	x: { values: readonly number[]; edges: number[] },
	y: { values: readonly number[]; edges: number[] },
	residual: readonly number[],
	kept: Uint8Array,
	noise: number,
): ResidualMap {
	const columns = Math.max(0, x.edges.length - 1);
	const rows = Math.max(0, y.edges.length - 1);
	const sums = Array.from({ length: columns * rows }, () => new Sums());
	for (let i = 0; i < residual.length; i++) {
		if (!kept[i]) continue;
		const column = binOf(x.edges, x.values[i]!);
		const row = binOf(y.edges, y.values[i]!);
		if (column >= 0 && row >= 0) sums[row * columns + column]!.add(residual[i]!);
	}
	return { x: x.edges, y: y.edges, cells: sums.map((s) => s.tally(noise)) };
}
