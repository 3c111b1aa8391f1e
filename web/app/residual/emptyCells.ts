import type { Bins } from './bins';
import type { ResidualMap } from './map';

type Span = readonly [from: number, to: number];

/** Range of the bins `first` to `last`. */
function span({ edges, setPoints: levels, factor = 1 }: Bins, first: number, last: number): Span {
	const ends = levels ? [levels[first]!, levels[last]!] : [edges[first]!, edges[last + 1]!];
	return [ends[0]! * factor, ends[1]! * factor];
}

/** Conditions of a map without any sample: for each step of y the ranges of x. */
export function emptyCells({ x, y, cells }: ResidualMap): { y: Span; x: Span }[] {
	const columns = x.edges.length - 1;
	return y.edges.slice(1).flatMap((_edge, row) => {
		const empty = cells.slice(row * columns, (row + 1) * columns).map(({ n }) => n === 0);
		const begins = empty.flatMap((one, i) => (one && !empty[i - 1] ? [i] : []));
		return begins.map((first) => {
			const next = empty.indexOf(false, first);
			return { y: span(y, row, row), x: span(x, first, (next < 0 ? columns : next) - 1) };
		});
	});
}
