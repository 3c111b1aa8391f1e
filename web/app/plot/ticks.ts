import { formatNumber } from '../format/number';

/** The smallest number of ticks for a readable scale. */
const MIN_TICKS = 3;

/** About `count` round positions for an axis, at least three: steps of 1, 2, 2.5 or 5 times a power of ten. */
export function ticks(low: number, high: number, count: number): number[] {
	const span = high - low;
	if (!(span > 0) || !Number.isFinite(span)) return Number.isFinite(low) ? [low] : [];
	const rough = span / Math.max(1, count);
	const power = 10 ** Math.floor(Math.log10(rough));
	const wanted = [1, 2, 5, 10].find((one) => one * power >= rough * 0.999)!;
	const finer = [5, 2.5, 2, 1, 0.5, 0.25].filter((one) => one < wanted);
	const reach = (step: number) => [Math.ceil(low / step - 1e-9), Math.floor(high / step + 1e-9)] as const;
	const enough = [wanted, ...finer].find((one) => {
		const [first, last] = reach(one * power);
		return last - first + 1 >= MIN_TICKS;
	})!;
	const step = enough * power;
	const [first, last] = reach(step);
	return Array.from({ length: last - first + 1 }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

/** A tick without unnecessary zeros. */
export function tickText(tick: number): string {
	const size = Math.abs(tick);
	if (size !== 0 && (size < 1e-4 || size >= 1e6)) return formatNumber(tick, 2);
	return String(Number(tick.toPrecision(6))).replace('-', '−');
}

/** The ticks of one axis with equal decimals: as many as one of them needs. */
export function tickTexts(axis: readonly number[]): string[] {
	const texts = axis.map(tickText);
	if (texts.some((text) => text.includes('·'))) return texts;
	const decimals = Math.max(0, ...texts.map((text) => text.split('.')[1]?.length ?? 0));
	return axis.map((tick) => tick.toFixed(decimals).replace('-', '−'));
}

/** Round positions of an axis with their texts. */
export function labelledTicks(low: number, high: number, count: number): { tick: number; text: string }[] {
	const found = ticks(low, high, count);
	const texts = tickTexts(found);
	return found.map((tick, i) => ({ tick, text: texts[i]! }));
}

/** A tick of a logarithmic scale: ten to the given power. */
export const powerText = (power: number): string => formatNumber(10 ** power, Number.isInteger(power) ? 1 : 2);
