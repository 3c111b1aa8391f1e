/** Paths of a figure: converts points on paper to path data for SVG and canvas. */
import type { Glyph } from './figure';

type Point = readonly [x: number, y: number];
const n = (value: number) => value.toFixed(1);

/** A line, broken where a point is not a number. */
export function line(points: readonly Point[]): string {
	let path = '';
	let joined = false;
	for (const [x, y] of points) {
		const there = Number.isFinite(x) && Number.isFinite(y);
		if (there) path += `${joined ? 'L' : 'M'}${n(x)} ${n(y)}`;
		joined = there;
	}
	return path;
}

/** Area between a lower and an upper line. */
export function ribbon(lower: readonly Point[], upper: readonly Point[]): string {
	const around = line([...lower, ...upper.toReversed()]);
	return around && `${around}Z`;
}

const SHAPES: Record<Glyph, string> = {
	dot: 'm-2.6 0a2.6 2.6 0 1 0 5.2 0a2.6 2.6 0 1 0-5.2 0',
	ring: 'm-2.9 0a2.9 2.9 0 1 0 5.8 0a2.9 2.9 0 1 0-5.8 0',
	square: 'm-2.5-2.5h5v5h-5z',
	cross: 'm-2.8-2.8l5.6 5.6m0-5.6l-5.6 5.6',
	triangle: 'm0-3.2l3.2 5.4h-6.4z',
};

export const isOpen = (glyph: Glyph) => glyph === 'ring' || glyph === 'cross';

export function glyphs(points: readonly Point[], glyph: Glyph): string {
	return points
		.filter(([x, y]) => Number.isFinite(x) && Number.isFinite(y))
		.map(([x, y]) => `M${n(x)} ${n(y)}${SHAPES[glyph]}`)
		.join('');
}

/** Vertical intervals with end marks. */
export function whiskers(ends: readonly (readonly [x: number, low: number, high: number])[], foot: number): string {
	return ends.map(([x, low, high]) => `M${n(x - foot)} ${n(low)}h${n(2 * foot)}M${n(x)} ${n(low)}V${n(high)}M${n(x - foot)} ${n(high)}h${n(2 * foot)}`).join('');
}
