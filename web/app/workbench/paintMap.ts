import { colour, diverging } from '../plot/colour';
import { tickText, ticks } from '../plot/ticks';
import type { ResidualMap } from '../residual/map';
import { CLIP, score } from '../residual/tally';

export const MARGIN = { left: 58, right: 6, top: 6, bottom: 38 };

export interface Size {
	width: number;
	height: number;
}

/** Where a value of x (or y) lies on the canvas. */
export function place(edges: readonly number[], from: number, to: number): (value: number) => number {
	const low = edges[0] ?? 0;
	const span = (edges.at(-1) ?? 1) - low || 1;
	return (value) => from + ((value - low) / span) * (to - from);
}

export function axesOf(map: ResidualMap, size: Size) {
	return {
		x: place(map.x, MARGIN.left, size.width - MARGIN.right),
		y: place(map.y, size.height - MARGIN.bottom, MARGIN.top),
	};
}

/** Cells, hatching where there are too few points, ticks and titles. */
export function paintMap(
	ctx: CanvasRenderingContext2D,
	map: ResidualMap,
	size: Size,
	titles: { x: string; y: string },
	region: { x: readonly [number, number] | null; y: readonly [number, number] | null },
): void {
	const { x, y } = axesOf(map, size);
	const palette = [colour('--map-low'), colour('--map-mid'), colour('--map-high')] as const;
	ctx.clearRect(0, 0, size.width, size.height);
	const columns = map.x.length - 1;
	map.cells.forEach((cell, i) => {
		const column = i % columns;
		const row = Math.floor(i / columns);
		const [left, right] = [x(map.x[column]!), x(map.x[column + 1]!)];
		const [top, bottom] = [y(map.y[row + 1]!), y(map.y[row]!)];
		const box = [left, top, Math.max(1, right - left), Math.max(1, bottom - top)] as const;
		if (cell.n === 0) return;
		const z = score(cell);
		ctx.fillStyle = z === null ? colour('--map-none') : diverging(z / CLIP, ...palette);
		ctx.fillRect(...box);
		if (z === null) hatch(ctx, box);
		ctx.strokeStyle = colour('--panel');
		ctx.lineWidth = 1;
		ctx.strokeRect(...box);
	});
	frame(ctx, size);
	outline(ctx, size, region.x?.map(x) ?? null, region.y?.map(y) ?? null);
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

function outline(ctx: CanvasRenderingContext2D, size: Size, x: number[] | null, y: number[] | null): void {
	if (!x && !y) return;
	const [left = 0, right = 0] = x ?? [MARGIN.left, size.width - MARGIN.right];
	const [bottom = 0, top = 0] = y ?? [size.height - MARGIN.bottom, MARGIN.top];
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
	for (const tick of ticks(map.x[0]!, map.x.at(-1)!, 8)) ctx.fillText(tickText(tick), x(tick), foot + 5);
	ctx.fillText(titles.x, (MARGIN.left + size.width) / 2, foot + 21);
	ctx.textBaseline = 'middle';
	ctx.textAlign = 'right';
	for (const tick of ticks(map.y[0]!, map.y.at(-1)!, 5)) ctx.fillText(tickText(tick), MARGIN.left - 6, y(tick));
	ctx.save();
	ctx.translate(11, (MARGIN.top + foot) / 2);
	ctx.rotate(-Math.PI / 2);
	ctx.textAlign = 'center';
	ctx.fillText(titles.y, 0, 0);
	ctx.restore();
}
