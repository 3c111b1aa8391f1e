import type { Scale } from './number';

/** Display unit of speeds. Other units are unchanged. */
const RPM_PER_RAD_S = 30 / Math.PI;

export function speedScale(unit: string, rpm: boolean): Scale {
	return rpm && unit === 'rad/s' ? { factor: RPM_PER_RAD_S, unit: 'rpm' } : { factor: 1, unit };
}

const PREFIX: Record<string, number> = { '': 1, m: 1e-3, µ: 1e-6, k: 1e3 };

/** A sentence of the daemon with its speeds in the displayed unit. */
export function withDisplayedSpeeds(sentence: string, rpm: boolean): string {
	if (!rpm) return sentence;
	return sentence.replace(/([-−]?)(\d[\d.]*) ([mµk]?)rad\/s(?![\w²^])/g, (_all, sign: string, figure: string, prefix: string) => {
		const turns = Number(figure) * PREFIX[prefix]! * RPM_PER_RAD_S;
		return `${sign}${Number(turns.toPrecision(3))} rpm`;
	});
}

/** A column in the displayed unit; the same column if the unit is unchanged. */
export function scaledColumn<T extends ArrayLike<number | null>>(column: T, { factor }: Scale): ArrayLike<number | null> {
	if (factor === 1) return column;
	const out = new Array<number | null>(column.length);
	for (let i = 0; i < out.length; i++) out[i] = column[i] === null ? null : column[i]! * factor;
	return out;
}
