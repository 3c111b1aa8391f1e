import type { ResidualSet } from '../api/types';

type Column = (number | null)[];

/** The points in the order of x, in one list per drawing style. */
export interface OverlayData {
	x: number[];
	measured: Column;
	measuredInside: Column;
	measuredOutside: Column;
	measuredExcluded: Column;
	predicted: Column;
	predictedInside: Column;
	predictedOutside: Column;
	residual: Column;
	residualInside: Column;
	residualOutside: Column;
	residualExcluded: Column;
	/** Prediction and residual of the comparison version; empty without one. */
	other: Column;
	otherResidual: Column;
}

/**
 * `Inside`: selected points. `Outside`: points that are not part of the fit. `Excluded`: points that the user excluded.
 */
export function overlay(
	set: ResidualSet,
	xs: readonly number[],
	chosen: Uint8Array | null,
	residualFactor: number,
	ramps: boolean,
	other: ResidualSet | null = null,
): OverlayData {
	const order = xs.flatMap((value, i) => (Number.isFinite(value) && (ramps || !set.held_out[i]) ? [i] : []));
	order.sort((a, b) => xs[a]! - xs[b]!);
	const kind = order.map((i) => (set.excluded[i] ? 3 : chosen?.[i] ? 1 : set.held_out[i] ? 2 : 0));
	const pick = (values: readonly number[], which: number, factor = 1): Column =>
		order.map((i, k) => (kind[k] === which ? values[i]! * factor : null));
	return {
		x: order.map((i) => xs[i]!),
		measured: pick(set.measured, 0),
		measuredInside: pick(set.measured, 1),
		measuredOutside: pick(set.measured, 2),
		measuredExcluded: pick(set.measured, 3),
		predicted: order.map((i) => set.predicted[i]!),
		predictedInside: pick(set.predicted, 1),
		predictedOutside: pick(set.predicted, 2),
		residual: pick(set.error, 0, residualFactor),
		residualInside: pick(set.error, 1, residualFactor),
		residualOutside: pick(set.error, 2, residualFactor),
		residualExcluded: pick(set.error, 3, residualFactor),
		other: other ? order.map((i) => other.predicted[i]!) : [],
		otherResidual: other ? order.map((i) => other.error[i]! * residualFactor) : [],
	};
}
