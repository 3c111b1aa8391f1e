import { api } from '../api/client';
import type { Run } from '../api/types';
import { settle } from '../overview/settle.svelte';
import { envelope } from '../plot/envelope';
import type { View } from '../plot/gestures';
import { lab } from '../state/lab.svelte';
import { resource } from '../state/resource.svelte';
import { type Look, viewOf } from './follow';

const PIXELS = 1600;

/** What plots show of a run along time, and the samples for it: from memory while the run is on, else from the store. Call while a component is being set up. */
export function stretchOf(run: () => Run, live: () => boolean, look: () => Look) {
	const here = $derived(live() && lab.liveRun === run().id && lab.tape !== null);
	const view: View | null = $derived(viewOf(look(), (here && look().follow ? lab.shown_s : null) ?? 0));
	/** A stretch that is no longer in memory, or a run that is over, comes from the store. */
	const stored = $derived(!here || (!look().follow && (lab.tape?.first_s ?? Infinity) > (view?.[0] ?? -Infinity) + 0.05));
	const asked = settle(() => (stored ? JSON.stringify([run().id, look(), live()]) : null), 90);
	const history = resource(
		() => asked.value,
		async (_key, signal) => {
			const [from_s, to_s] = view ?? [undefined, undefined];
			const samples = await api.samples(run().id, { from_s, to_s, px: PIXELS }, signal);
			return { ...envelope(samples), names: samples.channels.map((channel) => channel.name) };
		},
	);
	return {
		get here() {
			return here;
		},
		get view() {
			return view;
		},
		/** The stretch on the screen, once there is one: before, nobody knows where cursors should stand. */
		get seen(): View | null {
			if (view) return view;
			void lab.frames;
			const [first, last] = stored ? [history.data?.time[0], history.data?.time.at(-1)] : [lab.tape?.first_s, lab.tape?.last_s];
			return first != null && last != null && first < last ? [first, last] : null;
		},
		/** Why there is nothing to show. */
		get refused() {
			return stored && !history.data ? history.error : null;
		},
		get gaps() {
			return stored ? (history.data?.gaps ?? []) : (lab.tape?.gaps ?? []);
		},
		reload: history.reload,
		/** Time, and then one column for each name. */
		columns(names: readonly string[]): ArrayLike<number | null>[] {
			void lab.frames;
			if (!stored && lab.tape) {
				const { time, columns } = lab.tape.window(...(view ?? ([-Infinity, Infinity] as const)));
				return [time, ...names.map((name) => columns[lab.tape!.names.indexOf(name)] ?? [])];
			}
			const { data } = history;
			return [data?.time ?? [], ...names.map((name) => data?.columns[data.names.indexOf(name)] ?? [])];
		},
	};
}

export type Stretch = ReturnType<typeof stretchOf>;
