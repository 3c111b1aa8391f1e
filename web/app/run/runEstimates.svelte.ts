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
 * the last model of the bench. `shown` is the run, or `null` for none; the results of a run that has ended stay as they
 * are. Create it during component initialization.
 */
export class RunEstimates {
	identification: Identification | null = $state.raw(null);
	history: EstimateSnapshot[] = $state.raw([]);
	comparison: LiveComparison | null = $state.raw(null);
	error: ApiError | null = $state.raw(null);
	busy = $state(false);

	constructor(shown: () => number | null, isRunning: () => boolean) {
		const run = $derived(shown());
		$effect(() => this.follow(run, isRunning));
	}

	private follow(run: number | null, isRunning: () => boolean): (() => void) | undefined {
		this.identification = null;
		this.comparison = null;
		this.history = [];
		if (run === null) return;
		const abort = new AbortController();
		let timer: ReturnType<typeof setTimeout>;
		const ask = async () => {
			if (!isRunning()) return;
			const start_ms = performance.now();
			await this.request(run, abort.signal);
			if (!abort.signal.aborted) timer = setTimeout(() => void ask(), Math.max(EVERY_MS, WAIT_FACTOR * (performance.now() - start_ms)));
		};
		timer = setTimeout(() => void ask(), EVERY_MS / 2);
		return () => {
			abort.abort();
			clearTimeout(timer);
		};
	}

	private async request(run: number, signal: AbortSignal): Promise<void> {
		const slow = setTimeout(() => (this.busy = true), SLOW_MS);
		try {
			// The daemon refuses a run without samples, so it is not requested.
			if ((await api.run(run, signal)).rows > 0) {
				const identification = await api.identification(run, signal);
				this.identification = identification;
				this.comparison = await api.liveComparison(run, signal);
				this.history = [...this.history, { at_s: lab.feeds.get(run)?.samples?.last_s ?? this.history.length, quantities: identification.quantities }];
			}
			this.error = null;
		} catch (failure) {
			if (!signal.aborted) this.error = toApiError(failure);
		} finally {
			clearTimeout(slow);
			this.busy = false;
		}
	}
}
