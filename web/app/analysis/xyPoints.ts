/**
 * Points of one channel over another, in the order of x as a plot needs it. The directions of motion are separated if
 * they are known.
 */
export interface XyPoints {
	x: number[];
	/** Positive direction (or all points), then negative direction. */
	columns: (number | null)[][];
}

export function xyPoints(x: readonly (number | null)[], y: readonly (number | null)[], velocity: readonly (number | null)[] | null): XyPoints {
	const points = x.flatMap((at, i) => {
		const value = y[i];
		return at == null || value == null ? [] : [{ at, value, back: (velocity?.[i] ?? 0) < 0 }];
	});
	points.sort((a, b) => a.at - b.at);
	const column = (back: boolean) => points.map((one) => (velocity === null || one.back === back ? one.value : null));
	return { x: points.map(({ at }) => at), columns: velocity === null ? [column(false)] : [column(false), column(true)] };
}
