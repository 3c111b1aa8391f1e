import type { Component } from 'svelte';
import { type ApiError, toApiError } from '../api/apiError';

export interface Lazy<P extends Record<string, unknown>> {
	readonly component: Component<P> | null;
	/** Why loading failed; `reload` tries again. */
	readonly error: ApiError | null;
	reload: () => void;
	/** Loads it, if it is not loaded. */
	request: () => void;
}

/** A part of the dashboard whose script is loaded on demand. Call once for each part, outside of components. */
export function lazy<P extends Record<string, unknown>>(load: () => Promise<{ default: Component<P> }>): Lazy<P> {
	let loaded: Component<P> | null = $state.raw(null);
	let refused: ApiError | null = $state.raw(null);
	const request = async () => {
		refused = null;
		try {
			loaded = (await load()).default;
		} catch (failure) {
			refused = toApiError(failure);
		}
	};
	return {
		get component() {
			return loaded;
		},
		get error() {
			return refused;
		},
		reload: () => void request(),
		request: () => {
			if (!loaded) void request();
		},
	};
}
