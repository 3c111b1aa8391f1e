import type { FirstPassYield, Unit } from '../api/types';
import { formatCount, formatPercent } from '../format/number';

/** The levels of first-pass yield, as the daemon names them. */
export const YIELD_GROUPS = ['part', 'revision', 'batch'] as const;
export type YieldGroup = (typeof YIELD_GROUPS)[number];

export const readYieldGroup = (address: string | null): YieldGroup => YIELD_GROUPS.find((group) => group === address) ?? 'part';

/** `83.3 % of 6 units` */
export const yieldText = ({ fraction, units }: Pick<FirstPassYield, 'fraction' | 'units'>) => `${formatPercent(fraction, 1)} of ${formatCount(units, 'unit')}`;

/** `43.7 to 97.0 %` */
export function intervalText({ ci95: [low, high] }: Pick<FirstPassYield, 'ci95'>): string {
	return `${((low ?? 0) * 100).toFixed(1)} to ${formatPercent(high ?? 1, 1)}`;
}

/** The list of runs of one unit. */
export const unitRunsHref = (serial: string) => `/runs?search=${encodeURIComponent(/\s/.test(serial) ? `unit:"${serial}"` : `unit:${serial}`)}`;

/** `part P, revision B, batch 7` */
export function unitDetails({ part, revision, batch }: Pick<Unit, 'part' | 'revision' | 'batch'>): string {
	return Object.entries({ part, revision, batch }).flatMap(([name, text]) => (text ? [`${name} ${text}`] : [])).join(', ');
}
