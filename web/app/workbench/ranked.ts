import type { ResidualSet } from '../api/types';
import type { Bins } from '../residual/bins';
import type { Point } from '../residual/curve';

/** One axis with the residual along it. */
export interface Ranked {
	axis: ResidualSet['axes'][number];
	bins: Bins;
	/** Share of the residual's variance that depends on this axis. */
	share: number;
	all: Point[];
	positive: Point[];
	negative: Point[];
}
