import type { ResidualSet } from '../api/types';
import type { Region } from '../workbench/region';
import { type DirectionFilter, pointMask } from './points';

/** Quantities for selection in addition to the axes: the values of the point itself. */
export function axisValues(set: ResidualSet, name: string): readonly number[] | undefined {
	if (name === 'measured' || name === 'predicted') return set[name];
	return name === 'residual' ? set.error : set.axes.find((axis) => axis.name === name)?.values;
}

/** The samples of a region, one flag each; `null` without a selection, or if the run has no such axis. */
export function regionSamples(set: ResidualSet, region: Region | null, side: DirectionFilter, ramps: boolean): Uint8Array | null {
	if (!region) return null;
	const mask = pointMask(set, side, ramps);
	for (const { axis, from, to } of region) {
		const values = axisValues(set, axis);
		if (!values) return null;
		for (let i = 0; i < mask.length; i++) {
			if (!(values[i]! >= from && values[i]! <= to)) mask[i] = 0;
		}
	}
	return mask;
}
