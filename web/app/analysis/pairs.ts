/** Points of one channel over another, in the order of x, which a plot needs; apart by the direction of motion where that is known. */
export interface Pairs {
	x: number[];
	/** Forwards (or all), and backwards. */
	columns: (number | null)[][];
}

export function pairsOf(x: readonly (number | null)[], y: readonly (number | null)[], velocity: readonly (number | null)[] | null): Pairs {
	const points = x.flatMap((at, i) => {
		const value = y[i];
		return at == null || value == null ? [] : [{ at, value, back: (velocity?.[i] ?? 0) < 0 }];
	});
	points.sort((a, b) => a.at - b.at);
	const column = (back: boolean) => points.map((one) => (velocity === null || one.back === back ? one.value : null));
	return { x: points.map(({ at }) => at), columns: velocity === null ? [column(false)] : [column(false), column(true)] };
}
