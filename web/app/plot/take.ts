/** A plot on a canvas, to take away: its picture, and the numbers that it shows. */
import type { Curve } from './chart';
import { colour } from './colour';
import type { View } from './gestures';

const HEAD = 22;

/** The plot with its legend above it, as fine as the screen. */
export function picture(plot: HTMLCanvasElement, curves: readonly Curve[]): Promise<Blob> {
	const ratio = devicePixelRatio;
	const canvas = new OffscreenCanvas(plot.width, plot.height + HEAD * ratio);
	const ctx = canvas.getContext('2d')!;
	ctx.fillStyle = colour('--panel');
	ctx.fillRect(0, 0, canvas.width, canvas.height);
	ctx.drawImage(plot, 0, HEAD * ratio);
	ctx.scale(ratio, ratio);
	ctx.font = '12px system-ui, sans-serif';
	ctx.lineWidth = 2;
	let x = 58;
	for (const { label, stroke, mark, dash } of curves) {
		ctx.strokeStyle = ctx.fillStyle = colour(stroke);
		ctx.setLineDash(dash ?? []);
		ctx.beginPath();
		if (mark === 'dot' || mark === 'ring') ctx.arc(x + 10, 12, 3, 0, 2 * Math.PI);
		else {
			ctx.moveTo(x, 12);
			ctx.lineTo(x + 20, 12);
		}
		if (mark === 'dot') ctx.fill();
		else ctx.stroke();
		ctx.fillStyle = colour('--soft');
		ctx.fillText(label, x + 26, 16);
		x += 44 + ctx.measureText(label).width;
	}
	return canvas.convertToBlob({ type: 'image/png' });
}

export type Cells = (number | null)[];

/** Rows within the view, x first; `null` for a missing value. */
export function rowsIn(view: View | null, curves: readonly Curve[], data: readonly ArrayLike<number | null>[]): Cells[] {
	const x = data[0] ?? [];
	const rows: Cells[] = [];
	for (let i = 0; i < x.length; i++) {
		const at = x[i];
		if (at == null || (view && (at < view[0] || at > view[1]))) continue;
		rows.push([at, ...curves.map((_, c) => finite(data[c + 1]?.[i]))]);
	}
	return rows;
}

export const headOf = (xTitle: string, curves: readonly Curve[]): string[] => [xTitle, ...curves.map(({ label, unit }) => (unit ? `${label} [${unit}]` : label))];

const finite = (value: number | null | undefined) => (value == null || Number.isNaN(value) ? null : value);
