import type { UnitChange } from '../api/types';

/** Whether this run is outside the prediction interval of the earlier runs of its unit. */
export function isBeyondScatter({ present, prediction95 }: Pick<UnitChange, 'present' | 'prediction95'>): boolean {
	if (!prediction95) return false;
	const [low, high] = prediction95;
	return present < low! || present > high!;
}
