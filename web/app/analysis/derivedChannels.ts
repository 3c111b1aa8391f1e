import type { Channel } from '../api/types';
import { label } from '../format/label';

/** A channel that a formula derives from channels of the run. */
export interface DerivedChannel {
	formula: string;
	/** The user's title, else the formula itself. */
	title: string;
	/** The user's unit, else the unit that the daemon determines. */
	unit: string | null;
}

/** `drive power [W] = motor_torque_nm * motor_velocity_rad_s`, or only the formula. The daemon parses the formula. */
export function parseDerived(text: string): DerivedChannel {
	const equals = text.indexOf('=');
	const formula = text.slice(equals + 1).trim();
	if (equals < 0) return { formula, title: formula, unit: null };
	const [, title = '', unit] = /^\s*(.*?)\s*(?:\[([^\]]*)\])?\s*$/.exec(text.slice(0, equals)) ?? [];
	return { formula, title: title || formula, unit: unit ?? null };
}

/** Derived channels in the address, separated by semicolons, which no formula contains. */
export const readDerived = (text: string | null): string[] => (text ?? '').split(';').map((one) => one.trim()).filter(Boolean);
export const writeDerived = (list: readonly string[]): string | null => [...new Set(list)].join(';') || null;

/** Two channels or formulas, the first over the second: `y;x`. */
export function readAxes(text: string | null): { y: string; x: string } | null {
	const [y = '', x = ''] = readDerived(text);
	return y && x ? { y, x } : null;
}

export interface Signal {
	/** The formula for the request to the daemon. */
	formula: string;
	title: string;
	unit: string | null;
}

/** Everything that can be drawn: channels of the run and derived channels. */
export const signalsOf = (channels: readonly Channel[], derived: readonly string[]): Signal[] => [
	...channels.filter(({ name }) => !/^(segment|repeat)$/.test(name)).map(({ name, unit }) => ({ formula: name, ...label(name, unit) })),
	...derived.map(parseDerived),
];

export const withUnit = (title: string, unit: string | null | undefined): string => (unit && unit !== '1' ? `${title} [${unit}]` : title);
