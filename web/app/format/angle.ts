import type { Scale } from './number';

/** Display units of angles. Sent and stored values stay in rad. */
export const ANGLES = ['rad', '°', 'arcmin', 'arcsec'] as const;
export type Angle = (typeof ANGLES)[number];

const PER_RAD: Record<Angle, number> = { rad: 1, '°': 180 / Math.PI, arcmin: (60 * 180) / Math.PI, arcsec: (3600 * 180) / Math.PI };

export const parseAngle = (text: string | null): Angle => ANGLES.find((one) => one === text) ?? 'rad';

/** Scale of an angle, a compliance in it or a stiffness against it; other units are unchanged. */
export function angleScale(unit: string, angle: Angle): Scale {
	const per = PER_RAD[angle];
	if (unit === 'rad') return { factor: per, unit: angle };
	if (unit === 'rad/Nm') return { factor: per, unit: `${angle}/Nm` };
	if (unit === 'Nm/rad') return { factor: 1 / per, unit: `Nm/${angle}` };
	return { factor: 1, unit };
}

export const hasAngle = (units: Iterable<string>): boolean => [...units].some((unit) => angleScale(unit, '°').factor !== 1);
