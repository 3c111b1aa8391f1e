import type { Scale } from './number';

/** Speeds as a person wants to read them. Everything else stays as it is. */
export const RPM_PER_RAD_S = 30 / Math.PI;

export function speedScale(unit: string, rpm: boolean): Scale {
	return rpm && unit === 'rad/s' ? { factor: RPM_PER_RAD_S, unit: 'rpm' } : { factor: 1, unit };
}

/** A column in the shown unit; the same column where there is nothing to do. */
export function scaled<T extends ArrayLike<number | null>>(column: T, { factor }: Scale): ArrayLike<number | null> {
	if (factor === 1) return column;
	const out = new Array<number | null>(column.length);
	for (let i = 0; i < out.length; i++) out[i] = column[i] === null ? null : column[i]! * factor;
	return out;
}
