import type { Channel } from '../api/types';
import { label } from '../format/label';

/** A channel that a formula makes of those of the run. */
export interface Derived {
	formula: string;
	/** As a person calls it; else the formula itself. */
	title: string;
	/** As a person says; else what the daemon knows of it. */
	unit: string | null;
}

/** `drive power [W] = motor_torque_nm * motor_velocity_rad_s`, or the formula alone. The formula itself is the daemon's to read. */
export function derivedOf(text: string): Derived {
	const equals = text.indexOf('=');
	const formula = text.slice(equals + 1).trim();
	if (equals < 0) return { formula, title: formula, unit: null };
	const [, title = '', unit] = /^\s*(.*?)\s*(?:\[([^\]]*)\])?\s*$/.exec(text.slice(0, equals)) ?? [];
	return { formula, title: title || formula, unit: unit ?? null };
}

/** Derived channels in the address, with semicolons between; a formula has none. */
export const readDerived = (text: string | null): string[] => (text ?? '').split(';').map((one) => one.trim()).filter(Boolean);
export const writeDerived = (list: readonly string[]): string | null => [...new Set(list)].join(';') || null;

/** Two channels or formulas, the first over the second: `y;x`. */
export function readOver(text: string | null): { y: string; x: string } | null {
	const [y = '', x = ''] = readDerived(text);
	return y && x ? { y, x } : null;
}

export interface Choice {
	/** What the daemon is asked for. */
	formula: string;
	title: string;
	unit: string | null;
}

/** What can be drawn: the channels of the run, and what was derived from them. */
export const choicesOf = (channels: readonly Channel[], derived: readonly string[]): Choice[] => [
	...channels.filter(({ name }) => !/^(segment|repeat)$/.test(name)).map(({ name, unit }) => ({ formula: name, ...label(name, unit) })),
	...derived.map(derivedOf),
];

export const titled = (title: string, unit: string | null | undefined): string => (unit && unit !== '1' ? `${title} [${unit}]` : title);
