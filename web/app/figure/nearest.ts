/** The point nearest to the pointer [px], or none within reach. */
export interface PointedAt {
	series: number;
	index: number;
	at: readonly [x: number, y: number];
}

const REACH = 32;

export function nearest(places: readonly (readonly (readonly [x: number, y: number])[])[], x: number, y: number): PointedAt | null {
	let best: PointedAt | null = null;
	let least = REACH;
	places.forEach((points, series) =>
		points.forEach((at, index) => {
			const distance = Math.hypot(at[0] - x, at[1] - y);
			if (distance < least) [least, best] = [distance, { series, index, at }];
		}),
	);
	return best;
}
