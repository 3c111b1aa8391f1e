import { colour, diverging } from '../plot/colour';
import { type Bins, wholeBins } from '../residual/bins';
import type { ResidualMap } from '../residual/map';
import { type Place, middle, place } from '../residual/place';
import { beyond, deepest, depth, judged, score } from '../residual/tally';

export const MARGIN = { left: 58, right: 6, top: 6, bottom: 38 };

export interface Size {
	width: number;
	height: number;
}

export function axesOf(map: ResidualMap, size: Size): { x: Place; y: Place } {
	return {
		x: place(map.x, MARGIN.left, size.width - MARGIN.right, map.x.levels ? 14 : 8),
		y: place(map.y, size.height - MARGIN.bottom, MARGIN.top, map.y.levels ? 9 : 5),
	};
}

/** Cells, hatching where there are too few points, ticks and titles. */
export function paintMap(
	ctx: CanvasRenderingContext2D,
	map: ResidualMap,
	size: Size,
	titles: { x: string; y: string },
	region: { x: readonly [number, number] | null; y: readonly [number, number] | null },
	marked: ReadonlySet<number>,
): void {
	const { x, y } = axesOf(map, size);
	const palette = [colour('--map-lowest'), colour('--map-low'), colour('--map-mid'), colour('--map-high'), colour('--map-highest')] as const;
	const deep = deepest(map.cells);
	const shared = judged(map.cells);
	ctx.clearRect(0, 0, size.width, size.height);
	const [right, up] = [map.x.edges.map(x.at), map.y.edges.map(y.at)];
	const columns = right.length - 1;
	map.cells.forEach((cell, i) => {
		const column = i % columns;
		const row = Math.floor(i / columns);
		const [left, top] = [right[column]!, up[row + 1]!];
		const box = [left, top, Math.max(1, right[column + 1]! - left), Math.max(1, up[row]! - top)] as const;
		if (cell.n === 0) return;
		const z = score(cell);
		ctx.fillStyle = z === null ? colour('--map-none') : diverging(depth(z, deep), palette);
		ctx.fillRect(...box);
		if (z === null) hatch(ctx, box);
		ctx.strokeStyle = colour('--panel');
		ctx.lineWidth = 1;
		ctx.strokeRect(...box);
		if (beyond(cell, shared)) dot(ctx, box);
		if (marked.has(i)) mark(ctx, box);
	});
	frame(ctx, size);
	outline(ctx, size, wholeBins(map.x, region.x)?.map(x.at) ?? null, wholeBins(map.y, region.y)?.map(y.at) ?? null);
	ink(ctx, map, size, titles);
}

/** Inside the frame, bare paper is a condition that was never visited. */
function frame(ctx: CanvasRenderingContext2D, size: Size): void {
	const [width, height] = [size.width - MARGIN.left - MARGIN.right, size.height - MARGIN.top - MARGIN.bottom];
	ctx.strokeStyle = colour('--line');
	ctx.lineWidth = 1;
	ctx.strokeRect(MARGIN.left - 0.5, MARGIN.top - 0.5, width + 1, height + 1);
}

function hatch(ctx: CanvasRenderingContext2D, [left, top, width, height]: readonly [number, number, number, number]): void {
	ctx.save();
	ctx.beginPath();
	ctx.rect(left, top, width, height);
	ctx.clip();
	ctx.strokeStyle = colour('--faint');
	ctx.globalAlpha = 0.6;
	ctx.lineWidth = 1;
	ctx.beginPath();
	for (let s = Math.floor((left - height) / 6) * 6; s < left + width; s += 6) {
		ctx.moveTo(s, top + height);
		ctx.lineTo(s + height, top);
	}
	ctx.stroke();
	ctx.restore();
}

/** A cell whose mean is beyond the band of all cells together. */
function dot(ctx: CanvasRenderingContext2D, [left, top, width, height]: readonly [number, number, number, number]): void {
	ctx.fillStyle = colour('--ink');
	ctx.fillRect(left + width / 2 - 1, top + height / 2 - 1, 2, 2);
}

/** A cell with samples that were chosen in another plot. */
function mark(ctx: CanvasRenderingContext2D, [left, top, width, height]: readonly [number, number, number, number]): void {
	ctx.strokeStyle = colour('--panel');
	ctx.lineWidth = 3;
	ctx.strokeRect(left + 3, top + 3, Math.max(1, width - 6), Math.max(1, height - 6));
	ctx.strokeStyle = colour('--oi-purple');
	ctx.lineWidth = 1.6;
	ctx.strokeRect(left + 3, top + 3, Math.max(1, width - 6), Math.max(1, height - 6));
}

/** Both ends in order, far enough apart to be seen. */
function widen([a = 0, b = 0]: number[]): [number, number] {
	const [low, high] = [Math.min(a, b), Math.max(a, b)];
	const lack = Math.max(0, 8 - (high - low)) / 2;
	return [low - lack, high + lack];
}

function outline(ctx: CanvasRenderingContext2D, size: Size, x: number[] | null, y: number[] | null): void {
	if (!x && !y) return;
	const [left, right] = widen(x ?? [MARGIN.left, size.width - MARGIN.right]);
	const [top, bottom] = widen(y ?? [size.height - MARGIN.bottom, MARGIN.top]);
	ctx.save();
	ctx.beginPath();
	ctx.rect(MARGIN.left - 2, 0, size.width - MARGIN.left - MARGIN.right + 4, size.height - MARGIN.bottom + 2);
	ctx.clip();
	ctx.strokeStyle = colour('--ink');
	ctx.lineWidth = 2;
	ctx.setLineDash([6, 3]);
	ctx.strokeRect(left, top, right - left, bottom - top);
	ctx.restore();
}

function ink(ctx: CanvasRenderingContext2D, map: ResidualMap, size: Size, titles: { x: string; y: string }): void {
	const { x, y } = axesOf(map, size);
	const foot = size.height - MARGIN.bottom;
	ctx.fillStyle = colour('--soft');
	ctx.font = '11px system-ui, sans-serif';
	ctx.textBaseline = 'top';
	ctx.textAlign = 'center';
	for (const tick of x.ticks) ctx.fillText(x.say(tick), where(map.x, x, tick), foot + 5);
	ctx.fillText(titles.x, (MARGIN.left + size.width) / 2, foot + 21);
	ctx.textBaseline = 'middle';
	ctx.textAlign = 'right';
	for (const tick of y.ticks) ctx.fillText(y.say(tick), MARGIN.left - 6, where(map.y, y, tick));
	ctx.save();
	ctx.translate(11, (MARGIN.top + foot) / 2);
	ctx.rotate(-Math.PI / 2);
	ctx.textAlign = 'center';
	ctx.fillText(titles.y, 0, 0);
	ctx.restore();
}

const where = (bins: Bins, scale: Place, tick: number): number =>
	bins.levels ? middle(bins, scale, bins.levels.indexOf(tick)) : scale.at(tick);
