import type { ResidualSet } from '../api/types';
import { axisValues } from '../residual/regionSamples';

/** The run that visits a region again: `strokes` at its speeds, under its load. */
export interface RegionRun {
	parameters: Record<string, number>;
	/** Link torque that the brake has to supply; 0 without load. */
	load_nm: number;
	/** The brake cannot be set, because its torque is unknown. */
	loadUnknown: boolean;
}

export const VELOCITY = 'motor_velocity_rad_s';
export const LOAD = 'link_torque_nm';
/** Below this fraction of its rated torque a brake only has drag. */
const MIN_BRAKE_SHARE = 0.04;
const ACCELERATION_RAD_S2 = 400;
const DWELL_S = 0.7;
/** A wider region gets more speeds, evenly spaced in their logarithm. */
const SPEEDS_PER_DECADE = 4;

/** `null` if the region contains no sample in motion. */
export function regionRun(set: ResidualSet, chosen: Uint8Array, run: { parameters: Record<string, unknown>; meta: Record<string, unknown>; provenance: Record<string, unknown> }): RegionRun | null {
	const selectedValues = (name: string) => axisValues(set, name)?.filter((value, i) => chosen[i] && Number.isFinite(value)) ?? [];
	const speeds = selectedValues(VELOCITY).map(Math.abs).filter((speed) => speed > 0).sort((a, b) => a - b);
	if (speeds.length === 0) return null;
	// A few samples at the edges are ripple of another set-point.
	const [low, high] = [0.02, 0.98].map((share) => speeds[Math.round(share * (speeds.length - 1))]!);
	const levels = high! / low! < 1.15 ? 1 : Math.max(2, Math.min(8, 1 + Math.round(SPEEDS_PER_DECADE * Math.log10(high! / low!))));

	const loads = selectedValues(LOAD).map(Math.abs).sort((a, b) => a - b);
	const load_nm = loads.length ? loads[loads.length >> 1]! : 0;
	const constants = run.provenance['constants'] as Record<string, unknown> | undefined;
	const rated_nm = Number(constants?.['brake_rated_torque_nm'] ?? 0);
	const share = rated_nm > 0 ? load_nm / rated_nm : 0;
	const isBraked = share >= MIN_BRAKE_SHARE;
	const rate_hz = Number(run.meta['sample_rate_hz'] ?? 0);
	return {
		parameters: {
			low_speed_rad_s: rounded(levels === 1 ? high! : low!),
			top_speed_rad_s: rounded(high!),
			speeds: levels,
			load: isBraked ? Math.min(1, Number(share.toFixed(2))) : 0,
			repeats: 2,
			travel_rad: rounded(1.05 * strokeLength_rad(high!, Number(constants?.['gear_ratio'] ?? run.meta['gear_ratio'] ?? 1))),
			acceleration_rad_s2: ACCELERATION_RAD_S2,
			order_seed: Number(run.parameters['order_seed'] ?? 0) + 1,
			...(rate_hz > 0 ? { sample_rate_hz: rate_hz } : {}),
		},
		load_nm: isBraked ? load_nm : 0,
		loadUnknown: rated_nm === 0 && load_nm > 0,
	};
}

/** Link rotation of a stroke that accelerates to this speed, holds it and decelerates: `v·t + v²/a`. */
const strokeLength_rad = (speed_rad_s: number, gear: number) => Math.max(0.6, (speed_rad_s * DWELL_S + speed_rad_s ** 2 / ACCELERATION_RAD_S2) / gear);

/** Rounded as a user would type it. */
const rounded = (value: number) => Number(value.toPrecision(2));
