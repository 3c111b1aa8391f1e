import { api } from '../api/client';
import type { Run } from '../api/types';
import { lab } from '../state/lab.svelte';
import { resource } from '../state/resource.svelte';
import { router } from '../state/router.svelte';
import { reveal } from '../ui/reveal';
import type { View } from '../plot/gestures';
import { writeLook } from './plotRange';
import { stepsOf } from './plannedSteps';

/** Element id of the plots on the page of a run. */
export const PLOTS = 'plots';

/** Planned and executed steps of a run. Call during component initialization. */
export function courseOf(run: () => Run | undefined, live: () => boolean) {
	const id = $derived(run()?.id ?? null);
	/** An imported run has no plan; a run of an earlier version may have another plan now. */
	const plan = resource(
		() => (run()?.procedure === 'import' ? null : id),
		(of, signal) => api.plan(of, signal),
	);
	const kept = resource(
		() => (id === null ? null : `${id} ${live()} ${lab.line}`),
		(_key, signal) => api.events(id!, undefined, signal),
	);
	const events = $derived.by(() => {
		const before = kept.data ?? [];
		const last = before.at(-1)?.sequence ?? 0;
		return [...before, ...(id !== null && lab.liveRun === id ? lab.events.filter(({ sequence }) => sequence > last) : [])];
	});
	const made = $derived(stepsOf(events, events.at(-1)?.at_s ?? 0));
	return {
		plan,
		get made() {
			return made;
		},
	};
}

export type Course = ReturnType<typeof courseOf>;

/** Shows a time range of the run in its plots, and scrolls them into view. */
export function show(view: View): void {
	router.look({ view: writeLook({ follow: false, view }) }, 'box');
	void reveal(PLOTS);
}
