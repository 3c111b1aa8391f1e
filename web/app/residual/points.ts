import type { ResidualSet } from '../api/types';

export type DirectionFilter = 'both' | 'positive' | 'negative';

/**
 * Points that count: those of the fit in the selected direction of motion, without those that the user excluded. Ramps
 * and reversals are not part of the fit; they count only on request.
 */
export function pointMask(set: ResidualSet, side: DirectionFilter, ramps = false): Uint8Array {
	const direction = directionOf(set);
	return Uint8Array.from(set.error, (_, i) => {
		if (set.excluded[i]) return 0;
		if (set.held_out[i] && !ramps) return 0;
		if (side === 'both' || !direction) return 1;
		const sign = direction[i]!;
		return (side === 'positive' ? sign > 0 : sign < 0) ? 1 : 0;
	});
}

/**
 * Folds a position of more than one turn into one turn, as the diagnosis does, because position errors repeat with
 * every turn.
 */
export function foldPositions(set: ResidualSet): ResidualSet {
	const turn = 2 * Math.PI;
	const fold = (values: number[]) => {
		const [low, high] = values.reduce(([low, high], at) => [Math.min(low, at), Math.max(high, at)], [Infinity, -Infinity]);
		return high - low > turn ? values.map((at) => ((at % turn) + turn) % turn) : values;
	};
	return { ...set, axes: set.axes.map((axis) => (axis.name.endsWith('position_rad') ? { ...axis, values: fold(axis.values) } : axis)) };
}

/**
 * Adds the axes of the diagnosis that are not columns: time and distance since the last reversal, and the motor torque
 * in friction runs. The residual would have a slope over its own noise, so this torque is the model's, shifted to the
 * measured mean of each block.
 */
export function withDerivedAxes(set: ResidualSet): ResidualSet {
	const named = (name: string) => set.axes.find((axis) => axis.name === name);
	const direction = named('direction')?.values;
	const more: ResidualSet['axes'] = [];
	const since = (axis: ResidualSet['axes'][number] | undefined, name: string) => {
		if (!axis || !direction) return;
		let turn = axis.values[0]!;
		const values = axis.values.map((at, i) => {
			if (i > 0 && direction[i]! > 0 !== direction[i - 1]! > 0) turn = at;
			return Math.abs(at - turn);
		});
		more.push({ ...axis, name, values });
	};
	since(named('time_s'), 'time_since_reversal_s');
	since(named('motor_position_rad'), 'way_since_reversal_rad');
	if (named('motor_velocity_rad_s')) more.push({ name: 'motor_torque_nm', kind: 'response', unit: set.unit, values: torque(set) });
	return { ...set, axes: [...set.axes, ...more.filter(({ name }) => !named(name))] };
}

function torque({ error, predicted, piece }: ResidualSet): number[] {
	const means: { n: number; mean: number }[] = [];
	error.forEach((value, i) => {
		const one = (means[piece[i]!] ??= { n: 0, mean: 0 });
		one.mean += (value - one.mean) / ++one.n;
	});
	return predicted.map((value, i) => value + means[piece[i]!]!.mean);
}

/** The sign of the motion at each point, from the axis `direction` or from a velocity. */
export function directionOf(set: ResidualSet): readonly number[] | null {
	const named = set.axes.find((axis) => axis.name === 'direction');
	return (named ?? set.axes.find((axis) => axis.name.endsWith('velocity_rad_s')))?.values ?? null;
}

/** Axes along which the points differ; `segment` and `repeat` are only numbers. */
export function usefulAxes(set: ResidualSet, counted: Uint8Array): ResidualSet['axes'] {
	return set.axes.filter((axis) => {
		if (axis.name === 'segment' || axis.name === 'repeat') return false;
		const finite = axis.values.filter((value, i) => counted[i] && Number.isFinite(value));
		return finite.length > 1 && finite.some((value) => Math.abs(value - finite[0]!) > 1e-12 * Math.max(1, Math.abs(value)));
	});
}
