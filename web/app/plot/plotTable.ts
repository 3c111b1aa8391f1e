/** Exports the numbers of a plot. */
import type { Curve } from './chart';
import type { View } from './gestures';

export type TableRow = (number | null)[];

/** Rows within the view, x first; `null` for a missing value. */
export function visibleRows(view: View | null, curves: readonly Curve[], data: readonly ArrayLike<number | null>[]): TableRow[] {
	const x = data[0] ?? [];
	const rows: TableRow[] = [];
	for (let i = 0; i < x.length; i++) {
		const at = x[i];
		if (at == null || (view && (at < view[0] || at > view[1]))) continue;
		rows.push([at, ...curves.map((_, c) => finite(data[c + 1]?.[i]))]);
	}
	return rows;
}

export const tableHead = (xTitle: string, curves: readonly Curve[]): string[] => [xTitle, ...curves.map(({ label, unit }) => (unit ? `${label} [${unit}]` : label))];

const finite = (value: number | null | undefined) => (value == null || Number.isNaN(value) ? null : value);
