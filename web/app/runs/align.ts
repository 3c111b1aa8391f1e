import type { Channel, ChannelStatistics, RunEvent, Samples } from '../api/types';

/** One channel of a run over time. */
export interface ChannelCurve {
	x: number[];
	low: (number | null)[];
	high: (number | null)[];
}

/** A channel over time, starting at a time of the run. */
export function channelCurve(samples: Samples, channel: string, zero_s = 0): ChannelCurve | null {
	const values = samples.channels.find((one) => one.name === channel);
	return values ? { x: zero_s === 0 ? samples.time_s : samples.time_s.map((t) => t - zero_s), low: values.min, high: values.max } : null;
}

/** An event that occurs in every run. */
export interface SharedEvent {
	key: string;
	text: string;
	kind: string;
	/** Its first time in each run. */
	times_s: number[];
}

/** Events that occur in every run, by their key. */
export function sharedEvents(runs: readonly (readonly Pick<RunEvent, 'key' | 'text' | 'at_s' | 'kind'>[])[]): SharedEvent[] {
	const first = runs.map((events) => {
		const found = new Map<string, (typeof events)[number]>();
		for (const event of events) if (event.kind !== 'step_finished' && !found.has(event.key)) found.set(event.key, event);
		return found;
	});
	const everywhere = [...(first[0]?.values() ?? [])].filter(({ key }) => first.every((found) => found.has(key)));
	const shared = everywhere.map(({ key, text, kind }) => ({ key, text, kind, times_s: first.map((found) => found.get(key)!.at_s) }));
	// An event at the start of every run aligns like time itself.
	return shared.filter(({ times_s }) => times_s.some((at) => at > 0));
}

/**
 * The event for the typed text: an exact match, or the first that contains the text; `null` for no text, `undefined`
 * without a match.
 */
export function matchingEvent<T extends { text: string }>(typed: string, moments: readonly T[]): T | null | undefined {
	const words = typed.trim().toLowerCase();
	if (words === '') return null;
	return moments.find(({ text }) => text.toLowerCase() === words) ?? moments.find(({ text }) => text.toLowerCase().includes(words));
}

/**
 * All courses on one x, for a plot with a single x: minimum and maximum of each run in each bin, both at the same x, so
 * that a spike stays visible. `null` where a run has no data.
 */
export function alignCurves(courses: readonly (ChannelCurve | null)[], most = 500): { x: number[]; columns: (number | null)[][] } {
	const there = courses.filter((one) => one !== null);
	const xs = there.flatMap((one) => one.x.filter(Number.isFinite));
	if (xs.length === 0) return { x: [], columns: courses.map(() => []) };
	const [from, to] = xs.reduce(([low, high], x) => [Math.min(low, x), Math.max(high, x)], [Infinity, -Infinity] as [number, number]);
	const bins = Math.max(1, Math.min(most, ...there.map((one) => Math.ceil(one.x.length / 2))));
	const width = (to - from) / bins || 1;
	const columns = courses.map((course) => {
		const column: (number | null)[] = new Array<number | null>(2 * bins).fill(null);
		course?.x.forEach((x, i) => {
			const [low, high] = [course.low[i], course.high[i]];
			if (!Number.isFinite(x) || low == null || high == null) return;
			const bin = Math.min(bins - 1, Math.floor((x - from) / width));
			column[2 * bin] = Math.min(column[2 * bin] ?? Infinity, low);
			column[2 * bin + 1] = Math.max(column[2 * bin + 1] ?? -Infinity, high);
		});
		return column;
	});
	return { x: Array.from({ length: 2 * bins }, (_, i) => from + ((i >> 1) + 0.5) * width), columns };
}

/** Facts of several runs side by side, with dotted names. */
export function factTable(facts: readonly Record<string, unknown>[]): { name: string; values: string[]; differs: boolean }[] {
	const flat = facts.map((one) => new Map(flatten(one)));
	const names = [...new Set(flat.flatMap((one) => [...one.keys()]))];
	return names.map((name) => {
		const values = flat.map((one) => one.get(name) ?? '–');
		return { name, values, differs: new Set(values).size > 1 };
	});
}

/**
 * The mean of a channel side by side. Runs scatter, so two means differ only if their distance exceeds `least` and
 * twice the deviation within any run.
 */
export function meanRow(name: string, found: readonly (Pick<ChannelStatistics, 'mean' | 'deviation'> | undefined)[], least: number) {
	const means = found.flatMap((one) => one?.mean ?? []);
	const range = Math.max(...means) - Math.min(...means);
	return {
		name,
		values: found.map((one) => (one?.mean == null ? '–' : one.mean.toFixed(1))),
		differs: range > Math.max(least, ...found.map((one) => 2 * (one?.deviation ?? 0))),
	};
}

function flatten(value: unknown, name = ''): [string, string][] {
	if (value !== null && typeof value === 'object' && !Array.isArray(value)) {
		return Object.entries(value).flatMap(([key, inner]) => flatten(inner, name ? `${name}.${key}` : key));
	}
	// A part of a campaign is displayed as its procedure.
	return [[name, Array.isArray(value) ? value.map((one) => (one as { procedure?: string } | null)?.procedure ?? String(one)).join(', ') : String(value)]];
}

/** The channels in the address, in its order; without a name that all runs have, the first torque or current. */
export function chosenChannels(text: string | null, drawable: readonly Channel[]): Channel[] {
	const named = (text ?? '').split(',').flatMap((name) => drawable.find((one) => one.name === name) ?? []);
	if (named.length > 0) return [...new Set(named)];
	const usual = drawable.find((one) => /torque|current/.test(one.name)) ?? drawable[0];
	return usual ? [usual] : [];
}
