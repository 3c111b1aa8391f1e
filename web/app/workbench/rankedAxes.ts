import type { AxisKind, ResidualSet } from '../api/types';
import { type Bins, binOf, binsFor } from '../residual/bins';
import { type Point, curve, explainedShare } from '../residual/curve';
import { type DirectionFilter, directionOf, pointMask, usefulAxes } from '../residual/points';

/** One axis with the residual along it. */
export interface RankedAxis {
	axis: ResidualSet['axes'][number];
	bins: Bins;
	/** Fraction of the residual's variance that depends on this axis. */
	share: number;
	/**
	 * The same per direction, without the part that the direction alone explains: a part that changes sign with the
	 * direction averages out over both.
	 */
	splitShare: number;
	all: Point[];
	positive: Point[];
	negative: Point[];
}

/** Uncontrolled quantities: means of the segments are not set-points of these axes. */
const UNCONTROLLED = new Set<AxisKind>(['time', 'order', 'temperature', 'position', 'response']);

/** The usual axes of a friction run. */
const FRICTION_AXES = ['motor_velocity_rad_s', 'link_torque_nm', 'link_position_rad', 'motor_position_rad', 'time_s'];

/**
 * Default axes: always the same in friction runs, so that versions are comparable. Other runs use the axes on which the
 * measured value depends most.
 */
export function defaultAxes(set: ResidualSet, kind: string | undefined): string[] {
	return kind === 'friction' ? FRICTION_AXES : rankAxes(set, set.measured, 'both', false, 0).map((one) => one.axis.name);
}

/** Every axis with the curve of a quantity of the points, the axis with the largest explained fraction first. */
export function rankAxes(set: ResidualSet, figure: readonly number[], side: DirectionFilter, ramps: boolean, noise: number, shown: (unit: string) => { factor: number } = () => ({ factor: 1 })): RankedAxis[] {
	const counted = pointMask(set, side, ramps);
	const sides = { positive: pointMask(set, 'positive', ramps), negative: pointMask(set, 'negative', ramps) };
	const direction = side === 'both' ? directionOf(set) : null;
	const directionShare = direction ? explainedShare(direction, [-Infinity, 0, Infinity], figure, counted) : 0;
	return usefulAxes(set, counted)
		.map((axis) => {
			const bins = { ...binsFor(axis.values, UNCONTROLLED.has(axis.kind) ? [] : set.segment, counted), factor: shown(axis.unit).factor };
			const { edges } = bins;
			const curveOf = (which: Uint8Array) => curve(axis.values, edges, figure, which, noise, set.piece);
			const share = explainedShare(axis.values, edges, figure, counted);
			const cells = direction && axis.values.map((value, i) => 2 * binOf(edges, value) + (direction[i]! < 0 ? 1 : 0));
			return {
				axis,
				bins,
				share,
				splitShare: cells ? Math.max(0, explainedShare(cells, Array.from({ length: 2 * edges.length - 1 }, (_, i) => i), figure, counted) - directionShare) : share,
				all: curveOf(counted),
				positive: curveOf(sides.positive),
				negative: curveOf(sides.negative),
			};
		})
		.sort((a, b) => Math.max(b.share, b.splitShare) - Math.max(a.share, a.splitShare));
}
