import { labelledTicks } from '../plot/ticks';
import { type Figure, reachOf } from './figure';
import type { Tick } from './cartesian';

/** A figure around a centre: angle from the right, anticlockwise, as in mathematics. */
export interface PolarLayout {
	centre: { x: number; y: number };
	outer: number;
	/** Radius [px] of a value. */
	radius: (value: number) => number;
	at: (angle: number, value: number) => readonly [x: number, y: number];
	rings: Tick[];
	/** The circle of zero, if there are values on both sides of it. */
	zero: number | null;
}

/** Height of the title of the radius, below the disc. */
const TITLE = 16;

export const SPOKES = Array.from({ length: 12 }, (_, i) => i * 30);

export function polarLayout(figure: Figure, width: number, height: number, factor: number): PolarLayout {
	const outer = Math.max(20, Math.min(width - 70, height - 44 - TITLE) / 2);
	const centre = { x: width / 2, y: (height - TITLE) / 2 };
	const [least, most] = reachOf(figure.series);
	const span = most - Math.min(0, least) || Math.abs(most) || 1;
	// An error has values on both sides of its circle. The centre stays free, because values below zero would overlap
	// there.
	const low = least < 0 ? least - 0.6 * span : 0;
	const high = most + 0.06 * span;
	const radius = (value: number) => Math.max(0, ((value - low) / (high - low)) * outer);
	const begin = least < 0 ? least - 0.05 * span : 0;
	return {
		centre,
		outer,
		radius,
		at: (angle, value) => [centre.x + radius(value) * Math.cos(angle), centre.y - radius(value) * Math.sin(angle)],
		rings: labelledTicks(begin * factor, high * factor, least < 0 ? 6 : 4)
			.filter(({ tick }) => radius(tick / factor) > 12)
			.map(({ tick, text }) => ({ at: radius(tick / factor), text })),
		zero: least < 0 ? radius(0) : null,
	};
}
