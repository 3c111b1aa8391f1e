import type uPlot from 'uplot';
import { pixelScale } from './linePaths';

/** Above this number, points are drawn as squares, one per position, so that the cost depends on the visible area. */
const MANY = 1500;
/** Width of such a square, and half width of a dash. */
const SIDE = 3;
const HALF = 5;

/**
 * Calls `put` for the positions of the visible points. Of points that share a cell of `wide` × `high` pixels, only for
 * the first.
 */
function each(u: uPlot, index: number, from: number, to: number, cell: readonly [number, number] | null, put: (x: number, y: number, value: number) => void): void {
	const { left, top, x0, y1, kx, ky } = pixelScale(u);
	const [xs, ys] = [u.data[0]!, u.data[index]!];
	const { width, height } = u.bbox;
	// During layout a page may be narrower than the axis.
	if (!(width > 0 && height > 0)) return;
	const columns = cell ? Math.ceil(width / cell[0]) + 1 : 0;
	const rows = cell ? Math.ceil(height / cell[1]) + 1 : 0;
	const occupied = new Uint8Array(columns * rows);
	for (let i = from; i <= to; i++) {
		const value = ys[i];
		if (value == null) continue;
		const [x, y] = [(xs[i]! - x0) * kx, (y1 - value) * ky];
		if (cell) {
			const [column, row] = [Math.floor(x / cell[0]), Math.floor(y / cell[1])];
			if (column < 0 || row < 0 || column >= columns || row >= rows || occupied[row * columns + column]) continue;
			occupied[row * columns + column] = 1;
		}
		put(left + x, top + y, value);
	}
}

/** Each point separately: circles, or squares if there are many. A single point is visible in both cases. */
export function pointPaths(u: uPlot, index: number, from: number, to: number, filled: boolean, offset: number): uPlot.Series.Paths {
	const path = new Path2D();
	const ratio = devicePixelRatio;
	if (to - from > MANY) {
		const side = SIDE * ratio;
		each(u, index, from, to, [2 * ratio, 2 * ratio], (x, y) => path.rect(Math.round(x + offset - side / 2), Math.round(y - side / 2), side, side));
		return { stroke: null, fill: path };
	}
	const radius = (filled ? 2.5 : 2.7) * ratio;
	each(u, index, from, to, null, (x, y) => {
		path.moveTo(x + offset + radius, y);
		path.arc(x + offset, y, radius, 0, 2 * Math.PI);
	});
	return filled ? { stroke: null, fill: path } : { stroke: path };
}

/** A short horizontal line at each point for the value of the model, and a box for the scatter of repeats. */
export function dashPaths(u: uPlot, index: number, from: number, to: number, spread: number, offset: number): uPlot.Series.Paths {
	const [path, boxes] = [new Path2D(), new Path2D()];
	const half = HALF * devicePixelRatio;
	const { ky } = pixelScale(u);
	const cell = to - from > MANY ? ([half, devicePixelRatio] as const) : null;
	each(u, index, from, to, cell, (x, y) => {
		path.moveTo(x + offset - half, y);
		path.lineTo(x + offset + half, y);
		if (spread > 0) boxes.rect(x - half, y - spread * ky, 2 * half, 2 * spread * ky);
	});
	return { stroke: path, fill: boxes };
}
