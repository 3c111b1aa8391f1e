/** The background of a plot, behind its curves. */
import type uPlot from 'uplot';
import { colour } from './colour';

/** A set-point over time, or a constant limit. It does not change the scale, which depends only on the curves. */
export interface BackdropLine {
	label: string;
	/** In words, such as `± 20 rad/s`; empty for a set-point. */
	valueText: string;
	/** Custom property of the colour. */
	stroke: string;
	dash: number[];
	/** Heights of a constant limit. */
	levels: readonly number[];
	x: readonly number[];
	y: readonly number[];
}

export interface Backdrop {
	gaps: readonly (readonly [number, number])[];
	region: readonly [number, number] | null;
	/** Half height of a band around zero. */
	band: number | null;
	/** Times of notes. */
	notes: readonly number[];
	/** Start times of steps, in order. */
	steps: readonly number[];
	lines: readonly BackdropLine[];
}

export const EMPTY_BACKDROP: Backdrop = { gaps: [], region: null, band: null, notes: [], steps: [], lines: [] };

/** Smallest width of a step that is marked [px]. */
const NARROWEST = 5;

/** Time ranges of every second step in the view; none if the steps are too narrow on average. */
export function alternateSteps(steps: readonly number[], [from, to]: readonly [number, number], width_px: number): [number, number][] {
	const seen = steps.filter((at) => at > from && at < to).length;
	if (steps.length < 2 || width_px / (seen + 1) < NARROWEST) return [];
	return steps.flatMap((at, i) => {
		const [begin, end] = [Math.max(from, at), Math.min(to, steps[i + 1] ?? to)];
		return i % 2 === 1 && end > begin ? [[begin, end] as [number, number]] : [];
	});
}

/** Distance of the name of a limit from its line and from the border [px]. */
export const NAME_GAP = 4;

export function paintBackdrop(u: uPlot, { region, band, notes, steps, lines }: Backdrop): void {
	const { left, top, width, height } = u.bbox;
	const { ctx } = u;
	const x = (value: number) => u.valToPos(value, 'x', true);
	const y = (value: number) => u.valToPos(value, 'y', true);
	ctx.save();
	ctx.beginPath();
	ctx.rect(left, top, width, height);
	ctx.clip();
	const { min: from, max: to } = u.scales.x!;
	if (from != null && to != null) {
		ctx.fillStyle = colour('--step');
		for (const [begin, end] of alternateSteps(steps, [from, to], u.over.clientWidth)) ctx.fillRect(x(begin), top, x(end) - x(begin), height);
	}
	if (region) {
		const [from, to] = region.map(x) as [number, number];
		ctx.fillStyle = colour('--accent-wash');
		const width = Math.max(6 * devicePixelRatio, Math.abs(to - from));
		ctx.fillRect((from + to - width) / 2, top, width, height);
	}
	if (band !== null) {
		ctx.fillStyle = colour('--sunk');
		ctx.fillRect(left, y(band), width, y(-band) - y(band));
	}
	if (u.scales.y!.min != null) for (const line of lines) stroke(ctx, line, { left, width, x, y });
	ctx.fillStyle = colour('--ink');
	for (const at of notes) ctx.fill(flag(x(at), top, height, devicePixelRatio));
	ctx.restore();
}

interface Place {
	left: number;
	width: number;
	x: (value: number) => number;
	y: (value: number) => number;
}

function stroke(ctx: CanvasRenderingContext2D, line: BackdropLine, { left, width, x, y }: Place): void {
	ctx.beginPath();
	for (const level of line.levels) {
		ctx.moveTo(left, y(level));
		ctx.lineTo(left + width, y(level));
	}
	line.x.forEach((at, i) => (i === 0 ? ctx.moveTo(x(at), y(line.y[i]!)) : ctx.lineTo(x(at), y(line.y[i]!))));
	ctx.strokeStyle = colour(line.stroke);
	ctx.lineWidth = 1.3 * devicePixelRatio;
	ctx.setLineDash(line.dash.map((length) => length * devicePixelRatio));
	ctx.stroke();
	ctx.setLineDash([]);
}

/** Names of the limits in view, in front of the curves: each once, at its right end. */
export function paintLimitNames(u: uPlot, { lines }: Backdrop): void {
	const { left, top, width, height } = u.bbox;
	const { ctx } = u;
	const [size, gap] = [10 * devicePixelRatio, NAME_GAP * devicePixelRatio];
	ctx.save();
	ctx.font = `${size}px system-ui, sans-serif`;
	ctx.textAlign = 'right';
	for (const { label, levels, stroke } of lines) {
		const y = levels.map((level) => u.valToPos(level, 'y', true)).find((y) => y > top + size && y < top + height);
		if (y === undefined) continue;
		const [right, wide] = [left + width - gap, ctx.measureText(label).width];
		ctx.globalAlpha = 0.8;
		ctx.fillStyle = colour('--panel');
		ctx.fillRect(right - wide - gap, y - gap - size, wide + 2 * gap, size + gap);
		ctx.globalAlpha = 1;
		ctx.fillStyle = colour(stroke);
		ctx.fillText(label, right, y - gap);
	}
	ctx.restore();
}

/** A mark on the axis, with a thin line over the whole height. */
const flag = (x: number, top: number, height: number, size: number) => new Path2D(`M${x} ${top}h${size / 2}v${height - 8 * size}l${4 * size} ${8 * size}h${-8 * size}l${3.5 * size} ${-8 * size}Z`);
