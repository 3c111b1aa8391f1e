import { label } from '../format/label';
import { speedScale } from '../format/speed';
import type { Channel } from '../api/types';
import type { Curve } from '../plot/chart';
import { curveStyle } from '../plot/colour';

/** Channels that share a unit share a plot. */
export interface Group {
	unit: string;
	title: string;
	names: string[];
	curves: Curve[];
}

export const COUNTERS = new Set(['time_s', 'segment', 'repeat']);
/** What a unit measures, in the order in which people look at it. */
const QUANTITIES = new Map([
	['rad/s', 'velocity'],
	['Nm', 'torque'],
	['A', 'current'],
	['°C', 'temperature'],
	['rad', 'position'],
]);
const ORDER = [...QUANTITIES.keys()];

/** `rpm`: what is read in rad/s is shown in rpm; the group keeps the unit of its channels. */
export function groupsOf(channels: readonly Channel[], rpm = false): Group[] {
	const byUnit = new Map<string, string[]>();
	for (const channel of channels) {
		if (COUNTERS.has(channel.name)) continue;
		const { unit } = label(channel.name, channel.unit);
		byUnit.set(unit, [...(byUnit.get(unit) ?? []), channel.name]);
	}
	const place = (unit: string) => (ORDER.includes(unit) ? ORDER.indexOf(unit) : ORDER.length);
	return [...byUnit].map(([unit, names]) => makeGroup(unit, names, rpm)).sort((a, b) => place(a.unit) - place(b.unit));
}

function makeGroup(unit: string, names: string[], rpm: boolean): Group {
	const titles = names.map((name) => label(name).title);
	const title = QUANTITIES.get(unit) ?? titles.join(', ');
	const shown = speedScale(unit, rpm).unit;
	const curves = titles.map((title, i) => ({ label: title, unit: shown, mark: 'line' as const, ...curveStyle(i) }));
	return { unit, title: unit ? `${title} [${shown}]` : title, names, curves };
}
