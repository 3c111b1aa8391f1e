import { api } from '../api/client';
import type { IdentifiedQuantity, RunSummary } from '../api/types';
import { parameterSymbol } from '../format/symbol';
import { lab } from '../state/lab.svelte';
import { resource } from '../state/resource.svelte';
import { router } from '../state/router.svelte';
import { readQuantities, toggleQuantity } from './listView';
import { trendQuantities } from './trendFigure';

type Known = ReadonlyMap<number, IdentifiedQuantity[]>;
/** Results of complete runs do not change, so each is requested once. */
let known: Known = $state.raw(new Map());
const AGAIN_MS = 1000;

const hasResult = ({ state, procedure }: RunSummary) => state === 'completed' && procedure !== 'import';
const unknownOf = (runs: readonly RunSummary[]) => [...new Set(runs.filter(hasResult).map(({ id }) => id))].filter((id) => !known.has(id));

/** One request for the results of these runs. Returns whether some are not computed yet. */
async function request(ids: readonly number[], signal?: AbortSignal): Promise<boolean> {
	const { runs, pending, left_out } = await api.trends(`id>=${Math.min(...ids)} id<=${Math.max(...ids)}`, signal);
	const next = new Map([...known, ...runs.map(({ run, quantities }) => [run, quantities] as const)]);
	// A run without a result is not in the answer, which begins at its oldest run if older ones are omitted.
	const first = left_out > 0 ? (runs[0]?.run ?? Infinity) : 0;
	if (pending === 0) for (const id of ids) if (id >= first && !next.has(id)) next.set(id, []);
	known = next;
	return pending > 0;
}

/** All results of these runs, for a file. */
export async function allQuantities(runs: readonly RunSummary[]): Promise<Known> {
	for (let ids = unknownOf(runs); ids.length > 0; ) {
		const isPending = await request(ids);
		const left = unknownOf(runs);
		if (left.length === ids.length && !isPending) break;
		if (left.length === ids.length) await new Promise((done) => setTimeout(done, AGAIN_MS));
		ids = left;
	}
	return known;
}

/** An imported run has no procedure that identifies anything: its model has the only value. */
function ofModel({ procedure, model }: RunSummary): IdentifiedQuantity[] {
	if (procedure !== 'import' || !model?.coulomb) return [];
	const { name, unit, value, ci95 } = model.coulomb;
	const ends = ci95.flatMap((end) => end ?? []);
	return [{ name, symbol: parameterSymbol(name), title: 'Coulomb friction of the model', unit, value, ci95: ends.length === ci95.length ? ends : null }];
}

/** Columns for identified quantities of the runs on the screen. Call during component initialization. */
export function quantityColumns(visible: () => readonly RunSummary[]) {
	/** A text, so that a request that has found nothing new is not repeated at once. */
	const missing = $derived(unknownOf(visible()).join());
	const found = resource(
		() => (missing && lab.connected ? missing : null),
		(key, signal) => request(key.split(',').map(Number), signal),
	);
	$effect(() => {
		if (!found.data || found.loading) return;
		const again = setTimeout(found.reload, AGAIN_MS);
		return () => clearTimeout(again);
	});
	const of = (run: RunSummary) => known.get(run.id) ?? ofModel(run);
	/** Of all runs that were visible, so that a column keeps its title. */
	const available = $derived(trendQuantities([...known.values(), ...visible().map(ofModel)]));
	const names = $derived(readQuantities(router.query.get('columns'), localStorage));
	const shown = $derived(names.map((name) => available.find((one) => one.name === name) ?? { name, title: '', symbol: parameterSymbol(name) }));
	return {
		get shown() {
			return shown;
		},
		get addable() {
			return available.filter(({ name }) => !names.includes(name));
		},
		toggle: (name: string) => router.set({ columns: toggleQuantity(names, name, localStorage) }),
		of: (run: RunSummary, name: string) => of(run).find((one) => one.name === name),
	};
}
