import { api } from '../api/client';
import { ApiError } from '../api/apiError';
import type { RunSummary } from '../api/types';
import { formatCount } from '../format/number';
import { lab } from '../state/lab.svelte';
import { RELOAD_MS, reloadWhile, resource } from '../state/resource.svelte';
import { router } from '../state/router.svelte';
import { readQuantities, toggleQuantity } from './listView';
import { type Results, idRanges, ofModel, quantitiesOf, repetition, withAnswer } from './resultRequests';
import { trendQuantities } from './trendFigure';

/** Results of complete runs do not change, so each is requested once. */
let known: Results = $state.raw(new Map());

const hasResult = ({ state, procedure }: RunSummary) => state === 'completed' && procedure !== 'import';
const unknownOf = (runs: readonly RunSummary[]) => [...new Set(runs.filter(hasResult).map(({ id }) => id))].filter((id) => !known.has(id));

/** Requests the results of these runs. Returns the number of results in their ranges that are not computed yet. */
async function request(ids: readonly number[], signal?: AbortSignal): Promise<number> {
	const answers = [];
	for (const [first, last] of idRanges(ids)) {
		const asked = ids.filter((id) => id >= first && id <= last);
		answers.push({ asked, answer: await api.trends(`id>=${first} id<=${last}`, signal) });
	}
	for (const { asked, answer } of answers) known = withAnswer(known, asked, answer);
	return answers.reduce((sum, { answer }) => sum + answer.pending, 0);
}

/** All quantities of these runs, for a file. */
export async function allQuantities(runs: readonly RunSummary[]): Promise<Results> {
	const isRepeated = repetition();
	for (let ids = unknownOf(runs); ids.length > 0; ) {
		const pending = await request(ids);
		const left = unknownOf(runs);
		if (left.length > 0 && !isRepeated(left, pending)) throw new ApiError({ detail: `Nothing is exported: the results of ${formatCount(left.length, 'run')} are not computed yet.` });
		if (left.length === ids.length) await new Promise((done) => setTimeout(done, RELOAD_MS));
		ids = left;
	}
	return new Map(runs.map((run) => [run.id, quantitiesOf(known, run)]));
}

/** Titles of the quantities of all known results, by name. */
export const quantityTitles = (): ReadonlyMap<string, string> => new Map(trendQuantities([...known.values()]).map(({ name, title }) => [name, title]));

/** Columns for identified quantities of the runs on the screen. Call during component initialization. */
export function quantityColumns(visible: () => readonly RunSummary[]) {
	/** A text, so that a request that has found nothing new is not repeated at once. */
	const missing = $derived(unknownOf(visible()).join());
	const isRepeated = repetition();
	const requested = resource(
		() => (missing && lab.connected ? missing : null),
		async (key, signal) => {
			const pending = await request(key.split(',').map(Number), signal);
			return isRepeated(unknownOf(visible()), pending);
		},
	);
	reloadWhile(requested, () => requested.data === true && requested.error === null);
	/** Of all runs that were visible, so that a column keeps its title. */
	const available = $derived(trendQuantities([...known.values(), ...visible().map(ofModel)]));
	const names = $derived(readQuantities(router.query.get('columns'), localStorage));
	const shown = $derived(names.map((name) => available.find((one) => one.name === name) ?? { name, title: name, base_title: name, symbol: name }));
	return {
		requested,
		get shown() {
			return shown;
		},
		get addable() {
			return available.filter(({ name }) => !names.includes(name));
		},
		toggle: (name: string) => router.set({ columns: toggleQuantity(names, name, localStorage) }),
		isPending: (run: RunSummary) => hasResult(run) && !known.has(run.id),
		of: (run: RunSummary, name: string) => quantitiesOf(known, run).find((one) => one.name === name),
	};
}
