/** A plot as a vector drawing with the content of the canvas, to scale and edit. */
import { type Backdrop, alternateSteps } from './backdrop';
import type { Curve } from './chart';
import type { View } from './gestures';
import { powerText, tickText, ticks } from './ticks';

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
export function svgOf(drawing: Drawing, ink: (property: string) => string): string {
	const { curves, data, backdrop, width, height } = drawing;
	const [right, foot] = [width - RIGHT, height - FOOT];
	const x = (value: number) => LEFT + ((value - drawing.x[0]) / (drawing.x[1] - drawing.x[0])) * (right - LEFT);
	const y = (value: number) => foot - ((value - drawing.y[0]) / (drawing.y[1] - drawing.y[0])) * (foot - HEAD);
	const text = (at: readonly [number, number], label: string, more = '') => `<text x="${short(at[0])}" y="${short(at[1])}" fill="${ink('--soft')}" ${more}>${escaped(label)}</text>`;
	const path = (d: string, stroke: string, more = '') => `<path d="${d}" fill="none" stroke="${ink(stroke)}" ${more}/>`;
	const middle = 'text-anchor="middle"';

	const axes = [
		...ticks(...drawing.x, 8).flatMap((tick) => [path(`M${short(x(tick))} ${HEAD}V${foot}`, '--hair'), text([x(tick), foot + 16], tickText(tick), middle)]),
		...ticks(...drawing.y, 5).flatMap((tick) => [path(`M${LEFT} ${short(y(tick))}H${right}`, '--hair'), text([LEFT - 6, y(tick) + 4], (drawing.log ? powerText : tickText)(tick), 'text-anchor="end"')]),
		text([(LEFT + right) / 2, height - 8], drawing.xTitle, middle),
		text([0, 0], drawing.yTitle, `${middle} transform="translate(14 ${short((HEAD + foot) / 2)}) rotate(-90)"`),
	];
	const lineOf = ({ levels, x: xs, y: ys }: Backdrop['lines'][number]) =>
		levels.map((level) => `M${LEFT} ${short(y(level))}H${right}`).join('') + xs.map((at, i) => `${i ? 'L' : 'M'}${short(x(at))} ${short(y(ys[i]!))}`).join('');
	const backdropShapes = [
		...alternateSteps(backdrop.steps, drawing.x, right - LEFT).map(([begin, end]) => `<rect x="${short(x(begin))}" y="${HEAD}" width="${short(x(end) - x(begin))}" height="${foot - HEAD}" fill="${ink('--step')}"/>`),
		backdrop.region && `<rect x="${short(x(backdrop.region[0]))}" y="${HEAD}" width="${short(Math.max(2, x(backdrop.region[1]) - x(backdrop.region[0])))}" height="${foot - HEAD}" fill="${ink('--accent-wash')}"/>`,
		backdrop.band !== null && `<rect x="${LEFT}" y="${short(y(backdrop.band))}" width="${right - LEFT}" height="${short(y(-backdrop.band) - y(backdrop.band))}" fill="${ink('--sunk')}"/>`,
		...backdrop.lines.map((line) => path(lineOf(line), line.stroke, `stroke-dasharray="${line.dash.join(' ')}"`)),
		...backdrop.notes.map((at) => path(`M${short(x(at))} ${HEAD}V${foot - 8}l4 8h-8l4 -8`, '--ink', 'stroke-width="0.5"')),
	].filter((shape) => shape);
	const drawn = curves.map((curve, i) => {
		const points = pointsOf(data[0] ?? [], data[i + 1] ?? [], drawing.x);
		const at = points.map(([px, py]) => (py === null ? null : ([x(px), y(py)] as const)));
		const dash = curve.dash?.length ? `stroke-dasharray="${curve.dash.join(' ')}"` : '';
		if (curve.mark === 'line') return path(joined(points, at, backdrop.gaps), curve.stroke, dash);
		const seen = at.filter((one) => one !== null);
		const reach = ((curve.spread ?? 0) / (drawing.y[1] - drawing.y[0])) * (foot - HEAD);
		const band = (d: string) => (reach > 0 ? `<path d="${d}" fill="${ink(curve.stroke)}" fill-opacity="0.22"/>` : '');
		if (curve.mark === 'chord') {
			const [from, to] = [seen[0], seen.at(-1)].map((end) => end ?? ([0, 0] as const)) as [readonly [number, number], readonly [number, number]];
			const edge = ([px, py]: readonly [number, number], by: number) => `${short(px)} ${short(py + by)}`;
			return band(`M${edge(from, -reach)}L${edge(to, -reach)}L${edge(to, reach)}L${edge(from, reach)}Z`) + path(`M${edge(from, 0)}L${edge(to, 0)}`, curve.stroke, dash);
		}
		if (curve.mark === 'dash') {
			const boxes = band(seen.map(([px, py]) => `M${short(px - 5)} ${short(py - reach)}h10v${short(2 * reach)}h-10Z`).join(''));
			return boxes + path(seen.map(([px, py]) => `M${short(px - 5)} ${short(py)}h10`).join(''), curve.stroke, 'stroke-width="2"');
		}
		const dots = seen.map(([px, py]) => `M${short(px - 2.5)} ${short(py)}a2.5 2.5 0 1 0 5 0a2.5 2.5 0 1 0 -5 0`).join('');
		return curve.mark === 'dot' ? `<path d="${dots}" fill="${ink(curve.stroke)}"/>` : path(dots, curve.stroke);
	});
	let from = LEFT;
	const lines = backdrop.lines.map(({ label, valueText, stroke, dash }) => ({ label: `${label} ${valueText}`.trim(), stroke, dash, mark: 'line' as const }));
	const legend = [...curves, ...lines].map(({ label, stroke, mark, dash }) => {
		const d = mark === 'dot' || mark === 'ring' ? `M${from + 7.5} 13a2.5 2.5 0 1 0 5 0a2.5 2.5 0 1 0 -5 0` : `M${from} 13h20`;
		const entry = path(d, stroke, `stroke-width="2" stroke-dasharray="${dash?.join(' ') || 'none'}"`) + text([from + 26, 17], label);
		from += 46 + 6.6 * label.length;
		return entry;
	});
	return [
		`<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}" font-family="system-ui, sans-serif" font-size="11">`,
		`<title>${escaped(drawing.yTitle)}</title>`,
		`<clipPath id="inside"><rect x="${LEFT}" y="${HEAD}" width="${right - LEFT}" height="${foot - HEAD}"/></clipPath>`,
		`<rect width="${width}" height="${height}" fill="${ink('--panel')}"/>`,
		`<g clip-path="url(#inside)">${backdropShapes.join('')}</g>`,
		...axes,
		`<g clip-path="url(#inside)">${drawn.join('\n')}</g>`,
		...legend,
		'</svg>\n',
	].join('\n');
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

function joined(points: readonly Point[], at: readonly (readonly [number, number] | null)[], gaps: Backdrop['gaps']): string {
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
