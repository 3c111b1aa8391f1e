/**
 * Converts a displayed figure to a file. The content security policy of the page forbids images from memory, so the
 * shapes are read and drawn again.
 */

import { escaped } from '../plot/svg';

interface DrawnShape {
	/** Path data, or empty for a text. */
	d: string;
	text: string;
	matrix: DOMMatrix;
	fill: string;
	stroke: string;
	width: number;
	dash: number[];
	font: string;
	anchor: CanvasTextAlign;
	/** Clipping area. */
	clip?: string;
}

const TITLE = 24;
const MARGIN = 8;

function dataOf(shape: Element): string {
	const at = (name: string) => Number(shape.getAttribute(name) ?? 0);
	switch (shape.tagName) {
		case 'path':
			return shape.getAttribute('d') ?? '';
		case 'line':
			return `M${at('x1')} ${at('y1')}L${at('x2')} ${at('y2')}`;
		case 'rect':
			return `M${at('x')} ${at('y')}h${at('width')}v${at('height')}h${-at('width')}Z`;
		case 'circle': {
			const r = at('r');
			return `M${at('cx') - r} ${at('cy')}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`;
		}
		default:
			return '';
	}
}

/** `rgb(…)` combined with a separate opacity. */
const withOpacity = (colour: string, opacity: string) =>
	colour === 'none' || opacity === '1' ? colour : colour.replace(/^rgb\((.+)\)$/, (_all, parts: string) => `rgba(${parts}, ${opacity})`);

/** From the coordinates of a shape to those of the figure. */
const within = (host: Element) => new DOMMatrix().translate(-host.getBoundingClientRect().left, -host.getBoundingClientRect().top);

function shapesOf(host: Element): DrawnShape[] {
	return [...host.querySelectorAll<SVGGraphicsElement>(':is(path, line, rect, circle, text):not(clipPath *)')].map((shape) => {
		const style = getComputedStyle(shape);
		const isText = shape.tagName === 'text';
		const place = within(host).multiply(DOMMatrix.fromMatrix(shape.getScreenCTM()!));
		return {
			d: dataOf(shape),
			text: isText ? (shape.textContent ?? '') : '',
			matrix: isText ? place.translate(Number(shape.getAttribute('x') ?? 0), Number(shape.getAttribute('y') ?? 0)) : place,
			fill: withOpacity(style.fill, style.fillOpacity),
			stroke: withOpacity(style.stroke, style.strokeOpacity),
			width: Number.parseFloat(style.strokeWidth),
			dash: style.strokeDasharray === 'none' ? [] : style.strokeDasharray.split(/[ ,]+/).map(Number.parseFloat),
			clip: shape.closest('[clip-path]') ? dataOf(host.querySelector('clipPath > rect')!) : undefined,
			font: fontOf(style),
			anchor: style.textAnchor === 'middle' ? 'center' : style.textAnchor === 'end' ? 'right' : 'left',
		};
	});
}

const fontOf = (style: CSSStyleDeclaration) => `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;

/** The texts around the drawings, each at its position. */
function textsOf(host: Element): DrawnShape[] {
	const shapes: DrawnShape[] = [];
	const texts = document.createTreeWalker(host, NodeFilter.SHOW_TEXT);
	const range = document.createRange();
	for (let node = texts.nextNode(); node; node = texts.nextNode()) {
		const parent = node.parentElement!;
		if (parent.closest('svg, [class=hidden]')) continue;
		const style = getComputedStyle(parent);
		for (const { 0: text, index } of node.textContent!.matchAll(/\S+/g)) {
			range.setStart(node, index);
			range.setEnd(node, index + text.length);
			const box = range.getBoundingClientRect();
			shapes.push({ d: '', text, matrix: within(host).translate(box.left, box.bottom - 0.22 * box.height), fill: style.color, stroke: 'none', width: 0, dash: [], font: fontOf(style), anchor: 'left' });
		}
	}
	return shapes;
}

interface DrawnFigure {
	width: number;
	height: number;
	paper: string;
	shapes: DrawnShape[];
}

/** The figure with its title above and a margin around it. */
function drawnFigure(host: Element, title: string): DrawnFigure {
	const root = getComputedStyle(document.documentElement);
	const shapes = [...shapesOf(host), ...textsOf(host)].map((shape) => ({ ...shape, matrix: new DOMMatrix().translate(MARGIN, TITLE + MARGIN).multiply(shape.matrix) }));
	const head: DrawnShape = {
		d: '',
		text: title,
		matrix: new DOMMatrix().translate(MARGIN, MARGIN + 12),
		fill: root.getPropertyValue('--ink').trim(),
		stroke: 'none',
		width: 0,
		dash: [],
		font: `bold 13px ${root.getPropertyValue('--sans').trim()}`,
		anchor: 'left',
	};
	return {
		width: host.clientWidth + 2 * MARGIN,
		height: host.clientHeight + TITLE + 2 * MARGIN,
		paper: root.getPropertyValue('--panel').trim(),
		shapes: [head, ...shapes],
	};
}

export function svgFile(host: Element, title: string): Blob {
	const { width, height, paper, shapes: inks } = drawnFigure(host, title);
	const anchors: Partial<Record<CanvasTextAlign, string>> = { center: 'middle', right: 'end' };
	const body = inks.map((ink) => {
		const common = `transform="${ink.matrix.toString()}" fill="${ink.fill}" stroke="${ink.stroke}" stroke-width="${ink.width}"`;
		if (!ink.text) return `<path d="${ink.d}" ${common}${ink.dash.length ? ` stroke-dasharray="${ink.dash.join(' ')}"` : ''}/>`;
		return `<text ${common} paint-order="stroke" style="font:${escaped(ink.font)}" text-anchor="${anchors[ink.anchor] ?? 'start'}">${escaped(ink.text)}</text>`;
	});
	const head = `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}">`;
	return new Blob([`${head}\n<title>${escaped(title)}</title>\n<path d="M0 0h${width}v${height}H0Z" fill="${paper}"/>\n${body.join('\n')}\n</svg>\n`], { type: 'image/svg+xml' });
}

/** Twice the resolution of the screen, for slides and papers. */
const RESOLUTION = 2;

export async function pngFile(host: Element, title: string): Promise<Blob> {
	const { width, height, paper, shapes: inks } = drawnFigure(host, title);
	const canvas = new OffscreenCanvas(width * RESOLUTION, height * RESOLUTION);
	const ctx = canvas.getContext('2d')!;
	ctx.scale(RESOLUTION, RESOLUTION);
	ctx.fillStyle = paper;
	ctx.fillRect(0, 0, width, height);
	for (const ink of inks) {
		ctx.restore();
		ctx.save();
		ctx.setTransform(new DOMMatrix().scale(RESOLUTION).multiply(ink.matrix));
		if (ink.clip) ctx.clip(new Path2D(ink.clip));
		ctx.lineWidth = ink.width;
		ctx.setLineDash(ink.dash);
		ctx.font = ink.font;
		ctx.textAlign = ink.anchor;
		ctx.lineJoin = 'round';
		ctx.strokeStyle = ink.stroke;
		ctx.fillStyle = ink.fill;
		if (ink.text) {
			if (ink.stroke !== 'none') ctx.strokeText(ink.text, 0, 0);
			ctx.fillText(ink.text, 0, 0);
			continue;
		}
		const path = new Path2D(ink.d);
		if (ink.fill !== 'none') ctx.fill(path);
		if (ink.stroke !== 'none') ctx.stroke(path);
	}
	return canvas.convertToBlob({ type: 'image/png' });
}
