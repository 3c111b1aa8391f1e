import type { Gesture, View } from '../plot/gestures';

/** Time range of a live plot: the newest `width_s` seconds (all if infinite), or a fixed range. */
export type PlotRange = { follow: true; width_s: number } | { follow: false; view: View | null };

/**
 * The range after a gesture on the plot. A zoom continues to follow with a new width; the other gestures fix the range.
 */
export function afterGesture(range: PlotRange, view: View | null, hand: Gesture): PlotRange {
	if (view === null) return { follow: false, view: null };
	if (range.follow && hand === 'zoom') return { follow: true, width_s: Math.max(0.05, view[1] - view[0]) };
	return { follow: false, view };
}

export function rangeView(look: PlotRange, newest_s: number): View | null {
	if (!look.follow) return look.view;
	if (look.width_s < Infinity) return [newest_s - look.width_s, newest_s];
	return newest_s > 0 ? [0, newest_s] : null;
}

/** `follow:10` or `from:to`, for the address. */
export function writeRange(look: PlotRange): string {
	if (look.follow && look.width_s < Infinity) return `follow:${Number(look.width_s.toPrecision(4))}`;
	return !look.follow && look.view ? look.view.map((edge) => Number(edge.toPrecision(7))).join(':') : 'all';
}

export function readRange(text: string | null, live: boolean): PlotRange {
	if (text === null) return live ? { follow: true, width_s: 10 } : { follow: false, view: null };
	if (text === 'all' && live) return { follow: true, width_s: Infinity };
	const [first = '', second = ''] = text.split(':');
	if (first === 'follow' && Number(second) > 0) return live ? { follow: true, width_s: Number(second) } : { follow: false, view: null };
	const [from, to] = [Number(first), Number(second)];
	const whole = second !== '' && Number.isFinite(from) && Number.isFinite(to) && from < to;
	return { follow: false, view: whole ? [from, to] : null };
}

/** `Nm:3:5,A:all`: ranges of plots with their own zoom, by unit. */
export const writeOwnRanges = (owns: ReadonlyMap<string, string>): string => [...owns].map(([unit, look]) => `${unit}:${look}`).join();

export function readOwnRanges(text: string | null): Map<string, string> {
	return new Map(Array.from((text ?? '').matchAll(/([^:,]*):([^,]+)/g), ([, unit = '', look = '']) => [unit, look]));
}

/** `Nm:link torque:limit;A:brake current`: hidden curves and lines of the plots, by unit. Names may contain commas. */
export const writeHiddenCurves = (offs: ReadonlyMap<string, readonly string[]>): string => [...offs].flatMap(([unit, names]) => (names.length > 0 ? [[unit, ...names].join(':')] : [])).join(';');

export function readHiddenCurves(text: string | null): Map<string, string[]> {
	return new Map((text ?? '').split(';').flatMap((part) => {
		const [unit, ...names] = part.split(':');
		return unit !== undefined && names.length > 0 ? [[unit, names] as const] : [];
	}));
}
