import { type Scale, formatChange, formatNumber, withPrefix } from '../format/number';

/** A quantity of several runs, each with its known interval. */
export interface Estimate {
	value: number;
	ci95?: readonly (number | null)[] | null;
}

/** Change relative to the base: `+17 %`, or an absolute number times `factor`, if the base may be zero. */
export function changeFrom(base: Estimate | null, one: Estimate | null, factor = 1): string {
	if (!base || !one || base.value === 0) return '';
	const grown = one.value - base.value;
	return mayBeZero(base) ? `${grown >= 0 ? '+' : ''}${formatNumber(grown * factor, 2)}` : formatChange(grown / Math.abs(base.value));
}

/** A change relative to such a value has no meaning. */
export const mayBeZero = (base: Estimate): boolean => Math.abs(base.value) < (halfWidth(base) ?? 0);

function halfWidth({ ci95 }: Estimate): number | null {
	const [low, high] = ci95 ?? [];
	return low == null || high == null ? null : Math.abs(high - low) / 2;
}

/** Second minus first with the half width of its 95 % interval, for independent errors. `null` without both intervals. */
export function difference(first: Estimate | null, second: Estimate | null): { value: number; half: number } | null {
	const halves = [first, second].map((one) => (one ? halfWidth(one) : null));
	if (!first || !second || halves[0] == null || halves[1] == null) return null;
	return { value: second.value - first.value, half: Math.hypot(halves[0], halves[1]) };
}

/** The difference and its 95 % interval with one prefix: `−0.12 ± 0.31 mNm`. Empty without both intervals. */
export function differenceText(first: Estimate | null, second: Estimate | null, shown: Scale): string {
	const of = difference(first, second);
	if (!of) return '';
	const { factor, unit } = withPrefix(shown, [of.value, of.half]);
	const say = (value: number) => formatNumber(value * factor, 2);
	return `${of.value < 0 ? '' : '+'}${say(of.value)} ± ${say(of.half)}${unit ? ` ${unit}` : ''}`;
}

/**
 * Whether two of the runs differ at 95 %: their distance exceeds the combined interval, with independent errors. `null`
 * if fewer than two have an interval.
 */
export function estimatesDiffer(figures: readonly (Estimate | null)[]): boolean | null {
	const pairs = figures.flatMap((a, i) => figures.slice(i + 1).flatMap((b) => difference(a, b) ?? []));
	return pairs.length === 0 ? null : pairs.some(({ value, half }) => Math.abs(value) > half);
}
