import { api } from '../api/client';
import type { Run } from '../api/types';
import { debounced } from '../state/debounced.svelte';
import { envelope, joinColumns } from '../plot/envelope';
import type { View } from '../plot/gestures';
import { lab } from '../state/lab.svelte';
import { resource } from '../state/resource.svelte';
import { type PlotRange, rangeView } from './plotRange';

const PIXELS = 1600;
/** The daemon stores a run every two seconds. */
const COMMITTED_MS = 2500;
/** [s] A shorter gap is ignored. */
const MIN_GAP_S = 0.1;

/**
 * The time range of a run's plots and its samples: from memory during the run, else from the store. Call during
 * component initialization.
 */
export function sampleRange(run: () => Run, live: () => boolean, look: () => PlotRange) {
	const feed = $derived(lab.feeds.get(run().id));
	const isLive = $derived(live() && feed?.samples != null);
	const view: View | null = $derived(rangeView(look(), (isLive && look().follow ? feed?.shown_s : null) ?? 0));
	/** A range that is no longer in memory, or a finished run, is read from the store. */
	const stored = $derived(!isLive || (!look().follow && (feed?.samples?.first_s ?? Infinity) > (view?.[0] ?? -Infinity) + 0.05));
	const request = debounced(() => (stored ? JSON.stringify([run().id, look(), live()]) : null), 90);
	const history = resource(
		() => request.value,
		(_key, signal) => load(run().id, view?.[0], view?.[1], signal),
	);
	const before = samplesBefore(() => run().id, () => missingRange(look(), view, isLive ? (feed?.samples?.first_s ?? 0) : 0));
	return {
		get isLive() {
			return isLive;
		},
		get view() {
			return view;
		},
		/** The visible time range, as soon as there is one: before that, cursors have no position. */
		get visible(): View | null {
			if (view) return view;
			void lab.frames;
			const [first, last] = stored ? [history.data?.time[0], history.data?.time.at(-1)] : [feed?.samples?.first_s, feed?.samples?.last_s];
			return first != null && last != null && first < last ? [first, last] : null;
		},
		/** Why there is nothing to show. */
		get error() {
			return stored && !history.data ? history.error : null;
		},
		get gaps() {
			if (stored) return history.data?.gaps ?? [];
			const [first_s, last_s] = [feed?.samples?.first_s, before.data?.time.at(-1)];
			const hole: [number, number][] = first_s != null && last_s !== undefined && first_s - last_s > MIN_GAP_S ? [[last_s, first_s]] : [];
			return [...(before.data?.gaps ?? []), ...hole, ...(feed?.samples?.gaps ?? [])];
		},
		reload: history.reload,
		/** Time, then one column per name. */
		columns(names: readonly string[]): ArrayLike<number | null>[] {
			void lab.frames;
			if (!stored && feed?.samples) {
				const { time, columns } = feed.samples.window(...(view ?? ([-Infinity, Infinity] as const)));
				const seen = [time, ...names.map((name) => columns[feed!.samples!.names.indexOf(name)] ?? [])];
				return before.data ? joinColumns(named(before.data, names), seen) : seen;
			}
			return named(history.data, names);
		},
	};
}

/** Samples before the page connected. The store has the last of them two seconds later. */
function samplesBefore(run: () => number, missing: () => string | null) {
	const range = $derived(missing());
	const wanted = debounced(() => range, COMMITTED_MS);
	return resource(
		() => range && wanted.value,
		(key, signal) => {
			const [from_s, to_s] = key.split(':').map(Number);
			return load(run(), from_s, to_s, signal);
		},
	);
}

/** `from:to`, if the plots follow a run whose first samples in memory, from `first_s` on, are later than the view. */
function missingRange(look: PlotRange, view: View | null, first_s: number): string | null {
	if (!look.follow || first_s <= Math.max(0, view?.[0] ?? 0) + MIN_GAP_S) return null;
	return `${Math.max(0, first_s - look.width_s)}:${first_s}`;
}

async function load(run: number, from_s: number | undefined, to_s: number | undefined, signal: AbortSignal) {
	const samples = await api.samples(run, { from_s, to_s, px: PIXELS }, signal);
	return { ...envelope(samples), names: samples.channels.map((channel) => channel.name) };
}

interface Named {
	time: number[];
	columns: (number | null)[][];
	names: string[];
}

const named = (of: Named | undefined, names: readonly string[]) => [of?.time ?? [], ...names.map((name) => of?.columns[of.names.indexOf(name)] ?? [])];

export type SampleRange = ReturnType<typeof sampleRange>;
