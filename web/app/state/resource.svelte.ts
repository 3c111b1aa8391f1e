import { untrack } from 'svelte';
import { type ApiError, toApiError } from '../api/apiError';

export interface Resource<T> {
	readonly data: T | undefined;
	readonly error: ApiError | null;
	readonly loading: boolean;
	reload: () => void;
	/** Stores a newer value, such as the answer to a change. */
	put: (value: T) => void;
}

/**
 * Data that a page requests from the daemon. It is requested again when the key changes. The former answer stays
 * visible until the next one arrives, so that the layout is stable. A `null` key requests nothing.
 */
export function resource<K, T>(key: () => K | null, load: (key: K, signal: AbortSignal) => Promise<T>): Resource<T> {
	let data: T | undefined = $state.raw();
	let error: ApiError | null = $state.raw(null);
	let loading = $state(false);
	let turn = $state(0);

	let abort = new AbortController();
	let present: { key: K; turn: number } | null = null;

	$effect(() => {
		void turn;
		const wanted = key();
		untrack(() => request(wanted));
	});
	$effect(() => () => abort.abort());

	function request(wanted: K | null): void {
		// What the key reads may change without the key. A failed request is repeated then.
		if (present?.key === wanted && present.turn === turn && error === null) return;
		abort.abort();
		abort = new AbortController();
		present = wanted === null ? null : { key: wanted, turn };
		if (wanted === null) {
			data = undefined;
			error = null;
			loading = false;
			return;
		}
		const { signal } = abort;
		loading = true;
		load(wanted, signal).then(
			(value) => {
				if (signal.aborted) return;
				data = value;
				error = null;
				loading = false;
			},
			(failure: unknown) => {
				if (signal.aborted) return;
				error = toApiError(failure);
				loading = false;
			},
		);
	}

	return {
		get data() {
			return data;
		},
		get error() {
			return error;
		},
		get loading() {
			return loading;
		},
		reload: () => {
			loading = true;
			turn += 1;
		},
		put: (value: T) => {
			data = value;
			error = null;
		},
	};
}

/** Pause before a request for what was not computed yet. */
export const RELOAD_MS = 1000;

/**
 * Requests a resource again after a pause while its answer is incomplete. Call during component initialization.
 */
export function reloadWhile(source: Pick<Resource<unknown>, 'loading' | 'reload'>, isIncomplete: () => boolean): void {
	$effect(() => {
		if (source.loading || !isIncomplete()) return;
		const timer = setTimeout(source.reload, RELOAD_MS);
		return () => clearTimeout(timer);
	});
}
