/** Fewer steps in a row stay as they are. */
const LEAST_STEPS = 4;
const STEPS = new Set(['step_started', 'step_finished']);

/** Entries of a journal: one entry, or the entries of several steps in a row. */
export type JournalGroup<E> = { entry: E } | { steps: E[]; finished: number };

/** Folds entries of many steps in a row, so that events between steps stand out. The order stays. */
export function journalGroups<E extends { kind: string }>(entries: readonly E[]): JournalGroup<E>[] {
	const groups: JournalGroup<E>[] = [];
	for (let start = 0; start < entries.length; ) {
		let end = start;
		while (end < entries.length && STEPS.has(entries[end]!.kind)) end += 1;
		const steps = entries.slice(start, end);
		const finished = steps.filter(({ kind }) => kind === 'step_finished').length;
		if (finished >= LEAST_STEPS) groups.push({ steps, finished });
		else for (const entry of steps) groups.push({ entry });
		if (end < entries.length) groups.push({ entry: entries[end]! });
		start = end + 1;
	}
	return groups;
}
