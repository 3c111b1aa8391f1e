import { label } from '../format/label';
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

const COUNTERS = new Set(['time_s', 'segment', 'repeat']);
/** What people look at first. */
const ORDER = ['rad/s', 'Nm', 'A', '°C', 'rad'];

export function groupsOf(channels: readonly Channel[]): Group[] {
	const byUnit = new Map<string, string[]>();
	for (const channel of channels) {
		if (COUNTERS.has(channel.name)) continue;
		const { unit } = label(channel.name, channel.unit);
		byUnit.set(unit, [...(byUnit.get(unit) ?? []), channel.name]);
	}
	const place = (unit: string) => (ORDER.indexOf(unit) + ORDER.length + 1) % (ORDER.length + 1);
	return [...byUnit]
		.map(([unit, names]) => makeGroup(unit, names))
		.sort((a, b) => place(a.unit) - place(b.unit));
}

function makeGroup(unit: string, names: string[]): Group {
	const titles = names.map((name) => label(name).title);
	const title = titles.length === 1 ? titles[0]! : (commonWord(titles) ?? unit);
	const curves = titles.map((title, i) => ({ label: title, unit, mark: 'line' as const, ...curveStyle(i) }));
	return { unit, title: unit ? `${title} [${unit}]` : title, names, curves };
}

/** `velocity` for motor velocity and velocity set point. */
function commonWord(titles: readonly string[]): string | null {
	const [first = '', ...others] = titles;
	const shared = first.split(' ').filter((word) => others.every((title) => title.split(' ').includes(word)));
	return shared[0] ?? null;
}
