import { type Bins, binOf } from './bins';
import type { Point } from './curve';
import { type AxisScale, binMiddle } from './axisScale';
import { MIN_POINTS } from './blockMeans';

/** One curve of means, with its style. */
export interface MeanCurve {
	points: Point[];
	stroke: string;
	dash: string;
	/** Without points and bands. */
	lineOnly?: boolean;
	isWide?: boolean;
}

/** Points of a curve with enough samples, with their positions. */
export function visiblePoints(points: readonly Point[], bins: Bins, scale: AxisScale): (Point & { at: number })[] {
	return points.flatMap((p, i) => (hasEnoughSamples(p) ? [{ ...p, at: binMiddle(bins, scale, i) }] : []));
}

/** There are enough samples for a mean. */
export const hasEnoughSamples = (p: Point) => p.n >= MIN_POINTS && Number.isFinite(p.se);

/**
 * Half height of an axis for all these curves. Large standard errors of a few means must not reduce the scale of the
 * others.
 */
export function axisLimit(curves: readonly (readonly Point[])[]): number {
	const points = curves.flatMap((curve) => curve.filter(hasEnoughSamples));
	const usual = points.map((p) => p.se).sort((a, b) => a - b)[points.length >> 1] ?? 0;
	return Math.max(1e-12, ...points.map((p) => Math.abs(p.mean) + Math.min(2 * p.se, 2 * usual))) * 1.1;
}

/** Fraction of selected points per bin. */
export function selectedShares(values: readonly number[], { edges }: Bins, counted: Uint8Array, chosen: Uint8Array | null): number[] | null {
	if (!chosen) return null;
	const bins = edges.slice(1).map(() => ({ all: 0, chosen: 0 }));
	for (let i = 0; i < values.length; i++) {
		const bin = counted[i] ? bins[binOf(edges, values[i]!)] : undefined;
		if (!bin) continue;
		bin.all += 1;
		bin.chosen += chosen[i]!;
	}
	return bins.map(({ all, chosen: some }) => (all ? some / all : 0));
}
