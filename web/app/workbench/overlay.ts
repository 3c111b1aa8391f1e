import type { ResidualSet } from '../api/types';
import type { Stretch } from './region';

type Column = (number | null)[];

/** The points in the order of an axis, in one list for each way of drawing them. */
export interface OverlayData {
	x: number[];
	measured: Column;
	measuredInside: Column;
	measuredOutside: Column;
	predicted: Column;
	residual: Column;
	residualInside: Column;
	residualOutside: Column;
}

/** `Inside`: points in the chosen stretch. `Outside`: points that took no part in the fit. */
export function overlay(
	set: ResidualSet,
	axis: ResidualSet['axes'][number],
	region: Stretch | null,
	residualFactor: number,
	ramps: boolean,
): OverlayData {
	const order = axis.values.flatMap((value, i) => (Number.isFinite(value) && (ramps || !set.held_out[i]) ? [i] : []));
	order.sort((a, b) => axis.values[a]! - axis.values[b]!);
	const along = region ? set.axes.find((one) => one.name === region.axis)?.values : undefined;
	const inside = (i: number) => !!region && !!along && along[i]! >= region.from && along[i]! <= region.to;
	const kind = order.map((i) => (inside(i) ? 1 : set.held_out[i] ? 2 : 0));
	const pick = (values: readonly number[], which: number, factor = 1): Column =>
		order.map((i, k) => (kind[k] === which ? values[i]! * factor : null));
	return {
		x: order.map((i) => axis.values[i]!),
		measured: pick(set.measured, 0),
		measuredInside: pick(set.measured, 1),
		measuredOutside: pick(set.measured, 2),
		predicted: order.map((i) => set.predicted[i]!),
		residual: pick(set.error, 0, residualFactor),
		residualInside: pick(set.error, 1, residualFactor),
		residualOutside: pick(set.error, 2, residualFactor),
	};
}
