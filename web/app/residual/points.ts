import type { ResidualSet } from '../api/types';

export type Side = 'both' | 'positive' | 'negative';

/**
 * Which points count: none that a person excluded; those of the fit, in the chosen direction of motion. Ramps and reversals took no part in the fit;
 * they count only where they are asked for.
 */
export function keep(set: ResidualSet, side: Side, ramps = false): Uint8Array {
	const direction = directionOf(set);
	return Uint8Array.from(set.error, (_, i) => {
		if (set.excluded[i]) return 0;
		if (set.held_out[i] && !ramps) return 0;
		if (side === 'both' || !direction) return 1;
		const sign = direction[i]!;
		return (side === 'positive' ? sign > 0 : sign < 0) ? 1 : 0;
	});
}

/** The sign of the motion at each point, from the axis `direction` or from a velocity. */
export function directionOf(set: ResidualSet): readonly number[] | null {
	const named = set.axes.find((axis) => axis.name === 'direction');
	return (named ?? set.axes.find((axis) => axis.name.endsWith('velocity_rad_s')))?.values ?? null;
}

/** Axes along which the points that count differ at all; `segment` and `repeat` only number them. */
export function usefulAxes(set: ResidualSet, kept: Uint8Array): ResidualSet['axes'] {
	return set.axes.filter((axis) => {
		if (axis.name === 'segment' || axis.name === 'repeat') return false;
		const finite = axis.values.filter((value, i) => kept[i] && Number.isFinite(value));
		return finite.length > 1 && finite.some((value) => Math.abs(value - finite[0]!) > 1e-12 * Math.max(1, Math.abs(value)));
	});
}
