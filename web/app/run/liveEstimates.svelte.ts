import { api } from '../api/client';
import { type Refusal, asRefusal } from '../api/apiError';
import type { Beside, Identification } from '../api/types';
import { lab } from '../state/lab.svelte';
import type { Said } from './estimateHistory';

const EVERY_MS = 4000;
/** A run with a slow evaluation is requested less often, so that it uses at most a tenth of the daemon's time. */
const PATIENCE = 10;
/** A slower request is indicated, because the displayed answer may be outdated. */
const SLOW_MS = 400;

/**
 * Preliminary results of an active run, requested repeatedly: the quantities of the procedure, and the comparison with
 * the last model of the bench. `null` requests nothing. Call during component initialization.
 */
export function askSoFar(running: () => number | null) {
	let found = $state.raw<Identification | null>(null);
	let story: Said[] = $state.raw([]);
	let beside = $state.raw<Beside | null>(null);
	let refused = $state.raw<Refusal | null>(null);
	let busy = $state(false);

	const asked = $derived(running());
	$effect(() => {
		const run = asked;
		found = null;
		beside = null;
		story = [];
		if (run === null) return;
		const abort = new AbortController();
		let timer: ReturnType<typeof setTimeout>;
		const ask = async () => {
			const begun = performance.now();
			const slow = setTimeout(() => (busy = true), SLOW_MS);
			try {
				// The daemon refuses a run without samples, so it is not requested.
				if ((await api.run(run, abort.signal)).rows > 0) {
					found = await api.identification(run, abort.signal);
					beside = await api.beside(run, abort.signal);
					story = [...story, { at_s: lab.tape?.last_s ?? story.length, quantities: found.quantities }];
				}
				refused = null;
			} catch (failure) {
				if (abort.signal.aborted) return;
				refused = asRefusal(failure);
			} finally {
				clearTimeout(slow);
				busy = false;
			}
			timer = setTimeout(() => void ask(), Math.max(EVERY_MS, PATIENCE * (performance.now() - begun)));
		};
		timer = setTimeout(() => void ask(), EVERY_MS / 2);
		return () => {
			abort.abort();
			clearTimeout(timer);
		};
	});

	return {
		get found() {
			return found;
		},
		get beside() {
			return beside;
		},
		get story() {
			return story;
		},
		get busy() {
			return busy;
		},
		get error() {
			return refused;
		},
	};
}

export type SoFar = ReturnType<typeof askSoFar>;
