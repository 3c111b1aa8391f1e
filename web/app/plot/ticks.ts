import { figure } from '../format/number';

/** Round positions for an axis, about `count` of them: steps of 1, 2 or 5 times a power of ten. */
export function ticks(low: number, high: number, count: number): number[] {
	const span = high - low;
	if (!(span > 0) || !Number.isFinite(span)) return Number.isFinite(low) ? [low] : [];
	const rough = span / Math.max(1, count);
	const power = 10 ** Math.floor(Math.log10(rough));
	const step = [1, 2, 5, 10].map((m) => m * power).find((candidate) => candidate >= rough * 0.999)!;
	const first = Math.ceil(low / step - 1e-9);
	const last = Math.floor(high / step + 1e-9);
	return Array.from({ length: last - first + 1 }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

/** A tick without needless zeros. */
export function tickText(tick: number): string {
	const size = Math.abs(tick);
	if (size !== 0 && (size < 1e-4 || size >= 1e6)) return figure(tick, 2);
	return String(Number(tick.toPrecision(6))).replace('-', '−');
}
