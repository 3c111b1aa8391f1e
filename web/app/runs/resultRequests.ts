import type { IdentifiedQuantity, RunSummary, Trends } from '../api/types';

export type Results = ReadonlyMap<number, readonly IdentifiedQuantity[]>;

/** The daemon's limit of runs in an answer. */
const MAX_SPAN = 500;
/** Smaller gaps between ids do not need a request of their own. */
const MAX_GAP = 5;
/** Number of requests without progress. The daemon can have a run whose result it cannot compute. */
const MAX_STALLS = 5;

/** First and last id of each contiguous group. */
export function idRanges(ids: readonly number[]): [number, number][] {
	const ranges: [number, number][] = [];
	for (const id of ids.toSorted((a, b) => a - b)) {
		const last = ranges.at(-1);
		if (last && id - last[1] <= MAX_GAP && id - last[0] < MAX_SPAN) last[1] = id;
		else ranges.push([id, id]);
	}
	return ranges;
}

/** The results with those of an answer. A run without a result is not in a complete answer. */
export function withAnswer(known: Results, asked: readonly number[], { runs, pending }: Pick<Trends, 'runs' | 'pending'>): Results {
	const next = new Map([...known, ...runs.map(({ run, quantities }) => [run, quantities] as const)]);
	if (pending === 0) for (const id of asked) if (!next.has(id)) next.set(id, []);
	return next;
}

/** Decides whether a request is repeated: after progress, and a few times without. */
export function repetition() {
	let [wanted, least, stalls] = ['', Infinity, 0];
	return (missing: readonly number[], pending: number): boolean => {
		const progress = missing.join() !== wanted || pending < least;
		stalls = progress ? 0 : stalls + 1;
		[wanted, least] = [missing.join(), progress ? pending : least];
		return missing.length > 0 && stalls < MAX_STALLS;
	};
}

/** An imported run has no procedure that identifies anything: its model has the only value. */
export function ofModel({ procedure, model }: RunSummary): IdentifiedQuantity[] {
	if (procedure !== 'import' || !model?.coulomb) return [];
	const { name, unit, value, ci95 } = model.coulomb;
	const ends = ci95.flatMap((end) => end ?? []);
	return [{ name, symbol: 'τ_c', title: 'Coulomb friction of the model', unit, value, ci95: ends.length === ci95.length ? ends : null }];
}

/** The quantities of a run in the list and in its file. */
export const quantitiesOf = (results: Results, run: RunSummary): readonly IdentifiedQuantity[] => results.get(run.id) ?? ofModel(run);
