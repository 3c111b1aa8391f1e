import type { EarlierResult, IdentifiedQuantity } from '../api/types';
import { type Scale, formatQuantity as sized } from '../format/number';
import { formatDateTime } from '../format/time';
import { differenceText, estimatesDiffer } from '../runs/differences';
import { formatResult } from './presentation';

/**
 * A quantity of this run after those of earlier runs, oldest first; heights from 0, the lowest end of any interval, to
 * 1.
 */
export interface QuantityTrend {
	of: IdentifiedQuantity;
	dots: { run: number; at: number; ends: readonly [number, number] }[];
	/** Every dot in words. */
	text: string;
	/**
	 * Change relative to the run that is applied to the bench, else to the run before, if that has the quantity too.
	 */
	change: string;
	differs: boolean | null;
}

/** The reference of changes. */
export const referenceRun = (earlier: readonly EarlierResult[]): EarlierResult | undefined => earlier.find(({ holds }) => holds) ?? earlier[0];

export function quantityTrends(run: number, quantities: readonly IdentifiedQuantity[], earlier: readonly EarlierResult[], scale: (unit: string) => Scale): QuantityTrend[] {
	return quantities.flatMap((of) => {
		const named = ({ name }: IdentifiedQuantity) => name === of.name;
		const known = earlier.flatMap((one) => one.quantities.filter(named).map((quantity) => ({ ...one, quantity }))).reverse();
		if (known.length === 0) return [];
		const all = [...known, { run, created_at: '', quantity: of }];
		const reach = all.flatMap(({ quantity: { value, ci95 } }) => [value, ...(ci95 ?? [])]);
		const low = Math.min(...reach);
		const span = Math.max(...reach) - low;
		const height = (value: number) => (span > 0 ? (value - low) / span : 0.5);
		const shown = scale(of.unit);
		const texts = all.map(({ run, created_at, quantity }) => {
			const { value, interval, unit } = formatResult(quantity, shown);
			return [`#${run}`, created_at && formatDateTime(created_at), value, interval, unit].filter(Boolean).join(' ');
		});
		const before = referenceRun(earlier)!.quantities.find(named);
		const dots = all.map(({ run, quantity: { value, ci95 } }) => ({ run, at: height(value), ends: [height(ci95?.[0] ?? value), height(ci95?.[1] ?? value)] as const }));
		return [{ of, dots, text: texts.join('\n'), change: before ? changeText(before, of, shown) : '', differs: before ? estimatesDiffer([before, of]) : null }];
	});
}

/** The change with its 95 % interval, if both runs have one. */
function changeText(before: IdentifiedQuantity, of: IdentifiedQuantity, shown: Scale): string {
	const change = of.value - before.value;
	return differenceText(before, of, shown) || `${change < 0 ? '' : '+'}${sized(change * shown.factor, shown.unit, 2)}`;
}
