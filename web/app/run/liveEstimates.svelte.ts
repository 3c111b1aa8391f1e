import { api } from '../api/client';
import { type ApiError, toApiError } from '../api/apiError';
import type { LiveComparison, Identification } from '../api/types';
import { lab } from '../state/lab.svelte';
import type { EstimateSnapshot } from './estimateHistory';

const EVERY_MS = 4000;
/** A run with a slow evaluation is requested less often, so that it uses at most a tenth of the daemon's time. */
const WAIT_FACTOR = 10;
/** A slower request is indicated, because the displayed answer may be outdated. */
const SLOW_MS = 400;

/**
 * Preliminary results of an active run, requested repeatedly: the quantities of the procedure, and the comparison with
 * the last model of the bench. `null` requests nothing; those of a run that has ended stay as they are. Call during
 * component initialization.
 */
export function liveEstimates(shown: () => number | null, isRunning: () => boolean) {
	let identification = $state.raw<Identification | null>(null);
	let history: EstimateSnapshot[] = $state.raw([]);
	let comparison = $state.raw<LiveComparison | null>(null);
	let refused = $state.raw<ApiError | null>(null);
	let busy = $state(false);

	const activeRun = $derived(shown());
	$effect(() => {
		const run = activeRun;
		identification = null;
		comparison = null;
		history = [];
		if (run === null) return;
		const abort = new AbortController();
		let timer: ReturnType<typeof setTimeout>;
		const ask = async () => {
			if (!isRunning()) return;
			const start_ms = performance.now();
			const slow = setTimeout(() => (busy = true), SLOW_MS);
			try {
				// The daemon refuses a run without samples, so it is not requested.
				if ((await api.run(run, abort.signal)).rows > 0) {
					identification = await api.identification(run, abort.signal);
					comparison = await api.liveComparison(run, abort.signal);
					history = [...history, { at_s: lab.feeds.get(run)?.samples?.last_s ?? history.length, quantities: identification.quantities }];
				}
				refused = null;
			} catch (failure) {
				if (abort.signal.aborted) return;
				refused = toApiError(failure);
			} finally {
				clearTimeout(slow);
				busy = false;
			}
			timer = setTimeout(() => void ask(), Math.max(EVERY_MS, WAIT_FACTOR * (performance.now() - start_ms)));
		};
		timer = setTimeout(() => void ask(), EVERY_MS / 2);
		return () => {
			abort.abort();
			clearTimeout(timer);
		};
	});

	return {
		get identification() {
			return identification;
		},
		get beside() {
			return comparison;
		},
		get history() {
			return history;
		},
		get busy() {
			return busy;
		},
		get error() {
			return refused;
		},
	};
}

export type LiveEstimates = ReturnType<typeof liveEstimates>;
