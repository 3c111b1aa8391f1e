import { api } from '../api/client';
import type { Run } from '../api/types';
import { lab } from '../state/lab.svelte';
import { resource } from '../state/resource.svelte';
import { router } from '../state/router.svelte';
import { reveal } from '../ui/reveal';
import type { View } from '../plot/gestures';
import { writeRange } from './plotRange';
import { executedSteps } from './plannedSteps';

/** Element id of the plots on the page of a run. */
export const PLOTS_ID = 'plots';

/** Planned and executed steps of a run. Call during component initialization. */
export function runSteps(run: () => Run | undefined, live: () => boolean) {
	const id = $derived(run()?.id ?? null);
	/** An imported run has no plan; a run of an earlier version may have another plan now. */
	const plan = resource(
		() => (run()?.procedure === 'import' ? null : id),
		(of, signal) => api.plan(of, signal),
	);
	const storedEvents = resource(
		() => (id === null ? null : `${id} ${live()} ${lab.connected}`),
		(_key, signal) => api.events(id!, undefined, signal),
	);
	const events = $derived.by(() => {
		const before = storedEvents.data ?? [];
		const last = before.at(-1)?.sequence ?? 0;
		return [...before, ...((id !== null && lab.feeds.get(id)?.events) || []).filter(({ sequence }) => sequence > last)];
	});
	const executed = $derived(executedSteps(events, events.at(-1)?.at_s ?? 0));
	return {
		plan,
		get executed() {
			return executed;
		},
	};
}

export type RunSteps = ReturnType<typeof runSteps>;

/** Shows a time range of the run in its plots, and scrolls them into view. */
export function showInPlots(view: View): void {
	router.setRange({ view: writeRange({ follow: false, view }) }, 'box');
	void reveal(PLOTS_ID);
}
