import { untrack } from 'svelte';
import { api } from '../api/client';
import { action } from '../state/action.svelte';
import { requestedDiagnosis } from '../autopilot/autopilot';
import { lab } from '../state/lab.svelte';
import { resource } from '../state/resource.svelte';
import type { Workbench } from './workbench.svelte';

/**
 * The recommended run of a diagnosis: starts it, follows it and shows its result. Call during component initialization.
 */
export function measuring(workbench: Workbench) {
	const begun = action();
	/** The autopilot that this page started, with the version that requested it. */
	let mine: { flight: number; from: number } | null = $state.raw(null);
	const flights = resource(
		() => `${lab.autopilots} ${lab.connected}`,
		(_key, signal) => api.autopilots(signal),
	);
	/** The bench of the run, else the current bench. */
	const where = $derived(lab.benches?.find((one) => one.name === workbench.run.data?.bench) ?? lab.bench);
	const diagnosis = $derived(workbench.diagnosed ? (workbench.diagnosis.data?.id ?? null) : null);
	const flight = $derived(diagnosis === null ? null : (flights.data?.find((one) => requestedDiagnosis(one) === diagnosis) ?? null));

	/** The result is the same model on more data. It is displayed if the user still displays the original version. */
	$effect(() => {
		const ended = flights.data?.find((one) => one.id === mine?.flight && one.state !== 'running');
		if (!ended || !mine) return;
		const stayed = mine.from === untrack(() => workbench.model?.id);
		mine = null;
		if (ended.model != null && stayed) workbench.arrive(ended.model, 'The new run is measured: what the page says is of all runs together.');
	});

	async function start(): Promise<void> {
		const from = workbench.model?.id;
		if (diagnosis === null || !where || from === undefined) return;
		await begun.run(async () => {
			mine = { flight: (await api.experiment(diagnosis, where.name)).id, from };
			lab.autopilots += 1;
		});
	}

	return {
		start,
		get where() {
			return where;
		},
		get flight() {
			return flight;
		},
		get starting() {
			return begun.busy;
		},
		get error() {
			return begun.error;
		},
	};
}
