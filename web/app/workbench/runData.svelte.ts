import { api } from '../api/client';
import type { Run } from '../api/types';
import { effectTitle } from '../format/label';
import { parameterSymbol } from '../format/symbol';
import { lab } from '../state/lab.svelte';
import { resource } from '../state/resource.svelte';
import { isFinal } from '../ui/states';

/** What the daemon has about one run and its models. */
export class RunData {
	readonly id: number;

	constructor(id: number) {
		this.id = id;
	}

	readonly run = resource(
		() => `${this.id} ${lab.runStates[this.id] ?? ''} ${lab.connected}`,
		(_key, signal) => api.run(this.id, signal),
	);
	readonly models = resource(
		() => `${this.id} ${lab.models} ${lab.connected}`,
		(_key, signal) => api.models(this.id, signal),
	);
	readonly effects = resource(
		() => (this.run.data ? `${this.run.data.kind} ${lab.effects}` : null),
		(_key, signal) => api.effects(this.run.data?.kind ?? '', signal),
	);
	/** What the procedure itself has identified. */
	protected readonly result = resource(
		() => (this.run.data?.verdict ? this.id : null),
		(run, signal) => api.identification(run, signal),
	);
	/** Runs of the same kind. */
	protected readonly sameKind = resource(
		() => (this.run.data ? `kind:${this.run.data.kind}` : null),
		(search, signal) => api.runs({ limit: 100, search }, signal),
	);
	readonly similarRuns = $derived((this.sameKind.data?.runs ?? []).filter((one) => one.rows > 0 && one.is_modelled && isFinal(one.state)));
	readonly versions = $derived(this.models.data ?? []);
	readonly baseline = $derived(baselineOf(this.run.data));
	/** Quantities that the run itself has identified. */
	readonly runResult = $derived(this.result.data?.quantities ?? []);

	readonly titleOf = (effect: string): string => effectTitle(this.effects.data, effect);
	readonly symbolOf = ({ effect, name }: { effect: string; name: string }): string => parameterSymbol(this.effects.data?.find((one) => one.id === effect), name);
}

function baselineOf(run: Run | undefined): string[] {
	const given = run?.meta['baseline'];
	return Array.isArray(given) ? given.map(String) : [];
}
