import type { Suggestion } from '../api/types';

/** A range of one axis, as in the address: `motor_velocity_rad_s:3.2:8`. */
export interface AxisRange {
	axis: string;
	from: number;
	to: number;
}

/** Ranges that must all hold: one for a selection along an axis, two for a rectangle on the map. */
export type Region = readonly AxisRange[];

export function readRegion(text: string | null): Region | null {
	const stretches = (text ? text.split(',') : []).map(readAxisRange);
	return stretches.length > 0 && stretches.every((one) => one !== null) ? stretches : null;
}

function readAxisRange(text: string): AxisRange | null {
	const [axis = '', from = '', to = ''] = text.split(':');
	const stretch = { axis, from: Number(from), to: Number(to) };
	const whole = axis !== '' && from !== '' && to !== '' && Number.isFinite(stretch.from) && Number.isFinite(stretch.to);
	return whole ? stretch : null;
}

export function writeAxisRange({ axis, from, to }: AxisRange): string {
	return [axis, Number(from.toPrecision(6)), Number(to.toPrecision(6))].join(':');
}

export function writeRegion(region: Region | null): string | null {
	return region && region.length > 0 ? region.map(writeAxisRange).join(',') : null;
}

export function axisRange(region: Region | null, axis: string): readonly [number, number] | null {
	const stretch = region?.find((one) => one.axis === axis);
	return stretch ? [stretch.from, stretch.to] : null;
}

/** The view of a range with its surroundings, with a minimum width relative to the axis. */
export function withSurroundings({ from, to }: { from: number; to: number }, low: number, high: number): [number, number] {
	const half = Math.max((to - from) * 1.2, (high - low) * 0.06) || 0.5;
	const middle = (from + to) / 2;
	return [middle - half, middle + half];
}

export type EvidenceKind = Suggestion['evidence'] | 'confounded';

/** The kind of evidence; the numbers are displayed with it. */
export function evidenceKind({ evidence, confounded_with }: Pick<Suggestion, 'evidence' | 'confounded_with'>): EvidenceKind {
	return confounded_with.length > 0 ? 'confounded' : evidence;
}
