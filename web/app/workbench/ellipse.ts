import type { Parameter, TradeOff } from '../api/types';

/** Two parameters with a trade-off, and their joint region. */
export interface Ellipse {
	first: Parameter;
	second: Parameter;
	correlation: number;
	/** Outline of the joint 95 % region in multiples of each half interval, from the centre. */
	outline: readonly (readonly [x: number, y: number])[];
}

/** χ² with two degrees of freedom at 95 %, relative to 1.96 for a single parameter. */
const JOINT = Math.sqrt(-2 * Math.log(0.05)) / 1.959964;
const POINTS = 72;

/** The strongest first. A parameter without an interval has no region. */
export function ellipses(parameters: readonly Parameter[], tradeOffs: readonly TradeOff[]): Ellipse[] {
	const named = (name: string) => parameters.find((p) => `${p.effect}.${p.name}` === name);
	const bounded = (p: Parameter | undefined): p is Parameter => p !== undefined && half(p) > 0;
	return [...tradeOffs]
		.sort((a, b) => Math.abs(b.correlation) - Math.abs(a.correlation))
		.flatMap(({ first, second, correlation }) => {
			const [a, b] = [named(first), named(second)];
			return bounded(a) && bounded(b) ? [{ first: a, second: b, correlation, outline: outline(correlation) }] : [];
		});
}

/** Half of the interval of a parameter; NaN if the data sets no bound. */
export const half = ({ ci95: [low, high] }: Parameter): number => (low == null || high == null ? Number.NaN : (high - low) / 2);

function outline(correlation: number): [number, number][] {
	const across = Math.sqrt(Math.max(0, 1 - correlation * correlation));
	return Array.from({ length: POINTS }, (_, i) => {
		const angle = (2 * Math.PI * i) / POINTS;
		return [JOINT * Math.cos(angle), JOINT * (correlation * Math.cos(angle) + across * Math.sin(angle))];
	});
}
