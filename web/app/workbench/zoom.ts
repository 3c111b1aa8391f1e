import type { View } from '../plot/gestures';

/** The displayed range of x in the overlay, as in the address: `3.2:8`. */
export function readZoom(text: string | null): View | null {
	const [from = Number.NaN, to = Number.NaN] = text?.split(':').map(Number) ?? [];
	return Number.isFinite(from) && Number.isFinite(to) && from < to ? [from, to] : null;
}

export function writeZoom(view: readonly [number, number] | null): string | null {
	return view && view.map((edge) => Number(edge.toPrecision(6))).join(':');
}
