import type uPlot from 'uplot';

/** Up to this number of points, a curve is drawn unreduced, with a correct dash pattern along its length. */
const SPARSE = 600;

/** Pixels that a dashed line through dense data combines into one middle value. */
const STEP = 2;

/**
 * A line through the points, broken at gaps and at missing values. Dense data becomes its minimum and maximum in each
 * pixel column, one pixel wide: without a graphics card, wide or dashed lines of noise cost ten times as much. A dashed
 * line becomes the filled middle of that range, because dashes along noise are unreadable.
 */
export function linePaths(dash: readonly number[] | undefined, gaps: () => readonly (readonly [number, number])[]): uPlot.Series.PathBuilder {
	return (u, index, from, to) => {
		const sparse = to - from <= SPARSE;
		const series = u.series[index]!;
		series.width = sparse || dash?.length ? 1.5 : 1;
		series.dash = dash && [...dash];
		const path = new Path2D();
		const band = sparse || !dash?.length ? null : new Path2D();
		for (const [begin, end] of pieces(u.data[0]!, from, to, gaps())) line(u, index, begin, end, sparse, band, path);
		return { stroke: path, fill: band };
	};
}

/** Index ranges between gaps. */
function pieces(x: ArrayLike<number>, from: number, to: number, gaps: readonly (readonly [number, number])[]): [number, number][] {
	const cuts = gaps.filter(([, end]) => end > x[from]! && end <= x[to]!);
	const list: [number, number][] = [];
	let begin = from;
	for (const [, end] of cuts) {
		let i = begin;
		while (i <= to && x[i]! < end) i += 1;
		list.push([begin, i - 1]);
		begin = i;
	}
	return [...list, [begin, to]];
}

/**
 * Conversion from data units to canvas pixels. It must be fast: a plot of ten channels needs a million positions per
 * second.
 */
export interface PixelScale {
	left: number;
	top: number;
	/** Smallest displayed x, largest displayed y, and pixels per unit. */
	x0: number;
	y1: number;
	kx: number;
	ky: number;
}

export function pixelScale(u: uPlot): PixelScale {
	const { left, top, width, height } = u.bbox;
	const [{ min: x0 = 0, max: x1 = 1 }, { min: y0 = 0, max: y1 = 1 }] = [u.scales.x!, u.scales.y!];
	return { left, top, x0, y1, kx: width / (x1 - x0), ky: height / (y1 - y0) };
}

function line(u: uPlot, index: number, from: number, to: number, sparse: boolean, band: Path2D | null, path: Path2D): void {
	const [x, y] = [u.data[0]!, u.data[index]!];
	const { left, top, x0, y1, kx, ky } = pixelScale(u);
	let column = Number.NaN;
	let [low, high] = [0, 0];
	let joined = false;
	let middles: number[] = [];
	let [begun, ended] = [0, 0];
	const put = (px: number, py: number) => {
		if (joined) path.lineTo(px, py);
		else path.moveTo(px, py);
		joined = true;
	};
	const flushMiddle = () => {
		if (middles.length) put((begun + ended) / 2, middles.reduce((sum, one) => sum + one, 0) / middles.length);
		middles = [];
	};
	const flush = () => {
		if (Number.isNaN(column)) return;
		const [under, over] = [top + (y1 - low) * ky, top + (y1 - high) * ky];
		if (band) {
			band.rect(column, over, 1, under - over);
			if (column - begun >= STEP * devicePixelRatio) flushMiddle();
			if (middles.push((under + over) / 2) === 1) begun = column;
			ended = column;
		} else {
			put(column, under);
			if (high !== low) put(column, over);
		}
	};
	for (let i = from; i <= to; i++) {
		const value = y[i];
		if (value == null || value !== value) {
			flush();
			flushMiddle();
			column = Number.NaN;
			joined = false;
			continue;
		}
		const px = left + (x[i]! - x0) * kx;
		if (sparse) {
			put(px, top + (y1 - value) * ky);
			continue;
		}
		const here = Math.round(px);
		if (here === column) {
			if (value < low) low = value;
			else if (value > high) high = value;
		} else {
			flush();
			[column, low, high] = [here, value, value];
		}
	}
	flush();
	flushMiddle();
}
