import { api } from '../api/client';
import { type Refusal, asRefusal } from '../api/problem';
import type { Beside, Identification } from '../api/types';
import { lab } from '../state/lab.svelte';
import type { Said } from './soFar';

const EVERY_MS = 4000;
/** A run that takes long to work out is asked less often: a tenth of the daemon's time at most. */
const PATIENCE = 10;
/** What takes longer is told: the answer before is not the last word. */
const SLOW_MS = 400;

/** What a run says before it is over: the procedure's own figures and how it keeps to the bench's last model, asked for again and again. `null` asks nothing. Call while a component is being set up. */
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
				// A run without a sample is refused: it is not asked.
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
