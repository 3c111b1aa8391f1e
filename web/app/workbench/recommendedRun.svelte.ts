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
export function recommendedRun(workbench: Workbench) {
	const startAction = action();
	/** The autopilot that this page started, with the version that requested it. */
	let started: { autopilotId: number; from: number } | null = $state.raw(null);
	const autopilots = resource(
		() => `${lab.autopilots} ${lab.connected}`,
		(_key, signal) => api.autopilots(signal),
	);
	const bench = $derived(lab.benchOf(workbench.run.data));
	const diagnosis = $derived(workbench.diagnosisIsCurrent ? (workbench.diagnosis.data?.id ?? null) : null);
	const autopilot = $derived(diagnosis === null ? null : (autopilots.data?.find((one) => requestedDiagnosis(one) === diagnosis) ?? null));

	/** The result is the same model on more data. It is displayed if the user still displays the original version. */
	$effect(() => {
		const ended = autopilots.data?.find((one) => one.id === started?.autopilotId && one.state !== 'running');
		if (!ended || !started) return;
		const stayed = started.from === untrack(() => workbench.model?.id);
		started = null;
		if (ended.model != null && stayed) workbench.showNewVersion(ended.model, 'The new run is measured: what the page says is of all runs together.');
	});

	async function start(): Promise<void> {
		const from = workbench.model?.id;
		if (diagnosis === null || !bench || from === undefined) return;
		await startAction.run(async () => {
			started = { autopilotId: (await api.experiment(diagnosis, bench.name)).id, from };
			lab.autopilots += 1;
		});
	}

	return {
		start,
		get bench() {
			return bench;
		},
		get autopilot() {
			return autopilot;
		},
		get starting() {
			return startAction.busy;
		},
		get error() {
			return startAction.error;
		},
	};
}
