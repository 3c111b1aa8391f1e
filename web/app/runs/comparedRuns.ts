import { toggled } from '../state/toggled';

/** Compared runs, as in the address: `compare=12,9`. More than six curves are not distinguishable. */
export const MAX_COMPARED = 6;
export const COMPARE_LIMIT = `2 to ${MAX_COMPARED} runs can be compared`;

export function readComparedRuns(text: string | null): number[] {
	const ids = (text ?? '').split(',').map(Number);
	return [...new Set(ids.filter((id) => Number.isInteger(id) && id > 0))].slice(0, MAX_COMPARED);
}

/** The first run is the base of the comparison. */
export const withBase = (marked: readonly number[], id: number): number[] => [id, ...marked.filter((one) => one !== id)];

export function toggleComparedRun(marked: readonly number[], id: number): number[] {
	const next = toggled(marked, id);
	return next.length <= MAX_COMPARED ? next : [...marked];
}

/** The workbench with one model of all runs; the first run stores it. */
export const sharedModelHref = ([first, ...more]: readonly number[]): string => `/workbench/${first}${more.length ? `?more=${more.join(',')}` : ''}`;
