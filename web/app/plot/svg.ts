/** A plot as a vector drawing with the content of the canvas, to scale and edit. */
import { type Backdrop, NAME_GAP, alternateSteps } from './backdrop';
import type { Curve } from './chart';
import type { View } from './gestures';
import { labelledTicks, powerText } from './ticks';

export interface Drawing {
	xTitle: string;
	yTitle: string;
	curves: readonly Curve[];
	data: readonly ArrayLike<number | null>[];
	/** Ranges of the axes. */
	x: View;
	y: View;
	backdrop: Backdrop;
	width: number;
	height: number;
	/** The values are exponents of ten. */
	log?: boolean;
}

const [LEFT, RIGHT, HEAD, FOOT] = [76, 10, 26, 44];
export const escaped = (text: string) => text.replace(/[&<>"]/g, (letter) => `&#${letter.charCodeAt(0)};`);
const short = (pixels: number) => String(Number(pixels.toFixed(2)));

/** `ink` returns the colour of a custom property. */
export function svgOf(drawing: Drawing, ink: Ink): string {
	const { width, height } = drawing;
	const frame = frameOf(drawing);
	const { right, foot } = frame;
	return [
		`<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}" font-family="system-ui, sans-serif" font-size="11">`,
		`<title>${escaped(drawing.yTitle)}</title>`,
		`<clipPath id="inside"><rect x="${LEFT}" y="${HEAD}" width="${right - LEFT}" height="${foot - HEAD}"/></clipPath>`,
		`<rect width="${width}" height="${height}" fill="${ink('--panel')}"/>`,
		`<g clip-path="url(#inside)">${backdropShapes(drawing, frame, ink).join('')}</g>`,
		...axes(drawing, frame, ink),
		`<g clip-path="url(#inside)">${[...drawing.curves.map((_, i) => curveShape(drawing, i, frame, ink)), ...limitNames(drawing, frame, ink)].join('\n')}</g>`,
		...legend(drawing, ink),
		'</svg>\n',
	].join('\n');
}

type Ink = (property: string) => string;
type Place = readonly [x: number, y: number];

/** The area of the curves, and the places of values in it. */
function frameOf({ width, height, x, y }: Drawing) {
	const [right, foot] = [width - RIGHT, height - FOOT];
	return {
		right,
		foot,
		x: (value: number) => LEFT + ((value - x[0]) / (x[1] - x[0])) * (right - LEFT),
		y: (value: number) => foot - ((value - y[0]) / (y[1] - y[0])) * (foot - HEAD),
		/** Height of a difference of two values. */
		reach: (difference: number) => (difference / (y[1] - y[0])) * (foot - HEAD),
	};
}

type Frame = ReturnType<typeof frameOf>;

const text = (ink: Ink, at: Place, words: string, more = '', fill = '--soft') => `<text x="${short(at[0])}" y="${short(at[1])}" fill="${ink(fill)}" ${more}>${escaped(words)}</text>`;
const path = (ink: Ink, d: string, stroke: string, more = '') => `<path d="${d}" fill="none" stroke="${ink(stroke)}" ${more}/>`;
const dashes = (dash: readonly number[] | undefined) => (dash?.length ? `stroke-dasharray="${dash.join(' ')}"` : '');

function axes({ x, y, xTitle, yTitle, log, height }: Drawing, frame: Frame, ink: Ink): string[] {
	const { right, foot } = frame;
	const middle = 'text-anchor="middle"';
	return [
		...labelledTicks(...x, 8).flatMap(({ tick, text: label }) => [path(ink, `M${short(frame.x(tick))} ${HEAD}V${foot}`, '--hair'), text(ink, [frame.x(tick), foot + 16], label, middle)]),
		...labelledTicks(...y, 5).flatMap(({ tick, text: label }) => [path(ink, `M${LEFT} ${short(frame.y(tick))}H${right}`, '--hair'), text(ink, [LEFT - 6, frame.y(tick) + 4], log ? powerText(tick) : label, 'text-anchor="end"')]),
		text(ink, [(LEFT + right) / 2, height - 8], xTitle, middle),
		text(ink, [0, 0], yTitle, `${middle} transform="translate(14 ${short((HEAD + foot) / 2)}) rotate(-90)"`),
	];
}

/** Steps, region, band, lines and notes behind the curves. */
function backdropShapes({ backdrop, x }: Drawing, frame: Frame, ink: Ink): string[] {
	const { right, foot } = frame;
	const column = (begin: number, end: number, fill: string, least = 0) =>
		`<rect x="${short(frame.x(begin))}" y="${HEAD}" width="${short(Math.max(least, frame.x(end) - frame.x(begin)))}" height="${foot - HEAD}" fill="${ink(fill)}"/>`;
	const lineOf = ({ levels, x: xs, y: ys }: Backdrop['lines'][number]) =>
		levels.map((level) => `M${LEFT} ${short(frame.y(level))}H${right}`).join('') + xs.map((at, i) => `${i ? 'L' : 'M'}${short(frame.x(at))} ${short(frame.y(ys[i]!))}`).join('');
	const { band, region } = backdrop;
	return [
		...alternateSteps(backdrop.steps, x, right - LEFT).map(([begin, end]) => column(begin, end, '--step')),
		...(region ? [column(...region, '--accent-wash', 2)] : []),
		...(band === null ? [] : [`<rect x="${LEFT}" y="${short(frame.y(band))}" width="${right - LEFT}" height="${short(frame.reach(2 * band))}" fill="${ink('--sunk')}"/>`]),
		...backdrop.lines.map((line) => path(ink, lineOf(line), line.stroke, dashes(line.dash))),
		...backdrop.notes.map((at) => path(ink, `M${short(frame.x(at))} ${HEAD}V${foot - 8}l4 8h-8l4 -8`, '--ink', 'stroke-width="0.5"')),
	];
}

/** The i-th curve in the form of its mark. */
function curveShape({ curves, data, backdrop, x }: Drawing, i: number, frame: Frame, ink: Ink): string {
	const { mark, stroke, dash, spread = 0 } = curves[i]!;
	const points = pointsOf(data[0] ?? [], data[i + 1] ?? [], x);
	const at = points.map(([px, py]) => (py === null ? null : ([frame.x(px), frame.y(py)] as const)));
	if (mark === 'line') return path(ink, joined(points, at, backdrop.gaps), stroke, dashes(dash));
	const seen = at.filter((one) => one !== null);
	const reach = frame.reach(spread);
	const band = (d: string) => (reach > 0 ? `<path d="${d}" fill="${ink(stroke)}" fill-opacity="0.22"/>` : '');
	if (mark === 'chord') {
		const [from, to]: [Place, Place] = [seen[0] ?? [0, 0], seen.at(-1) ?? [0, 0]];
		const edge = ([px, py]: Place, by: number) => `${short(px)} ${short(py + by)}`;
		return band(`M${edge(from, -reach)}L${edge(to, -reach)}L${edge(to, reach)}L${edge(from, reach)}Z`) + path(ink, `M${edge(from, 0)}L${edge(to, 0)}`, stroke, dashes(dash));
	}
	if (mark === 'dash') {
		const boxes = band(seen.map(([px, py]) => `M${short(px - 5)} ${short(py - reach)}h10v${short(2 * reach)}h-10Z`).join(''));
		return boxes + path(ink, seen.map(([px, py]) => `M${short(px - 5)} ${short(py)}h10`).join(''), stroke, 'stroke-width="2"');
	}
	const dots = seen.map(([px, py]) => `M${short(px - 2.5)} ${short(py)}a2.5 2.5 0 1 0 5 0a2.5 2.5 0 1 0 -5 0`).join('');
	return mark === 'dot' ? `<path d="${dots}" fill="${ink(stroke)}"/>` : path(ink, dots, stroke);
}

const limitNames = ({ backdrop }: Drawing, { right, y }: Frame, ink: Ink): string[] =>
	backdrop.lines.flatMap(({ label, levels, stroke }) => {
		const halo = `text-anchor="end" paint-order="stroke" stroke="${ink('--panel')}" stroke-width="3"`;
		return levels.slice(0, 1).map((level) => text(ink, [right - NAME_GAP, y(level) - NAME_GAP], label, halo, stroke));
	});

function legend({ curves, backdrop }: Drawing, ink: Ink): string[] {
	let from = LEFT;
	const lines = backdrop.lines.map(({ label, valueText, stroke, dash }) => ({ label: `${label} ${valueText}`.trim(), stroke, dash, mark: 'line' as const }));
	return [...curves, ...lines].map(({ label, stroke, mark, dash }) => {
		const d = mark === 'dot' || mark === 'ring' ? `M${from + 7.5} 13a2.5 2.5 0 1 0 5 0a2.5 2.5 0 1 0 -5 0` : `M${from} 13h20`;
		const entry = path(ink, d, stroke, `stroke-width="2" ${dashes(dash)}`) + text(ink, [from + 26, 17], label);
		from += 46 + 6.6 * label.length;
		return entry;
	});
}

type Point = readonly [x: number, y: number | null];

/** The points in the view and one more on each side, so that lines reach the border. */
function pointsOf(xs: ArrayLike<number | null>, ys: ArrayLike<number | null>, [from, to]: View): Point[] {
	const points: Point[] = [];
	for (let i = 0; i < xs.length; i++) {
		const [before, here, after] = [xs[i - 1] ?? xs[i]!, xs[i], xs[i + 1] ?? xs[i]!];
		if (here == null || Math.max(here, after) < from || Math.min(here, before) > to) continue;
		const value = ys[i];
		points.push([here, value == null || Number.isNaN(value) ? null : value]);
	}
	return points;
}

function joined(points: readonly Point[], at: readonly (Place | null)[], gaps: Backdrop['gaps']): string {
	let isFirst = true;
	return at
		.map((one, i) => {
			const [last, here] = [points[i - 1]?.[0], points[i]?.[0]];
			if (last !== undefined && here !== undefined && gaps.some(([begin, end]) => last <= begin && here >= end)) isFirst = true;
			if (one === null) {
				isFirst = true;
				return '';
			}
			const step = `${isFirst ? 'M' : 'L'}${short(one[0])} ${short(one[1])}`;
			isFirst = false;
			return step;
		})
		.join('');
}
