import { formatChange, formatNumber } from '../format/number';

/** A quantity of several runs, each with its known interval. */
export interface Estimate {
	value: number;
	ci95?: readonly (number | null)[] | null;
}

/** Change relative to the base: `+17 %`, or an absolute number times `factor`, if the base may be zero. */
export function changeFrom(base: Estimate | null, one: Estimate | null, factor = 1): string {
	if (!base || !one || base.value === 0) return '';
	const grown = one.value - base.value;
	return Math.abs(base.value) < (halfWidth(base) ?? 0) ? `${grown >= 0 ? '+' : ''}${formatNumber(grown * factor, 2)}` : formatChange(grown / Math.abs(base.value));
}

function halfWidth({ ci95 }: Estimate): number | null {
	const [low, high] = ci95 ?? [];
	return low == null || high == null ? null : Math.abs(high - low) / 2;
}

/**
 * Whether two of the runs differ at 95 %: their distance exceeds the combined interval, with independent errors. `null`
 * if fewer than two have an interval.
 */
export function estimatesDiffer(figures: readonly (Estimate | null)[]): boolean | null {
	const known = figures.flatMap((one) => {
		const width = one && halfWidth(one);
		return one && width != null ? [{ value: one.value, width }] : [];
	});
	if (known.length < 2) return null;
	return known.some((a, i) => known.slice(i + 1).some((b) => Math.abs(a.value - b.value) > Math.hypot(a.width, b.width)));
}
