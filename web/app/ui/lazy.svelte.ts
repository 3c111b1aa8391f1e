import type { Component } from 'svelte';
import { type Refusal, asRefusal } from '../api/apiError';

export interface Later<P extends Record<string, unknown>> {
	readonly part: Component<P> | null;
	/** Why loading failed; `reload` tries again. */
	readonly error: Refusal | null;
	reload: () => void;
	/** Loads it, if it is not loaded. */
	want: () => void;
}

/** A part of the dashboard whose script is loaded on demand. Call once for each part, outside of components. */
export function later<P extends Record<string, unknown>>(load: () => Promise<{ default: Component<P> }>): Later<P> {
	let came: Component<P> | null = $state.raw(null);
	let refused: Refusal | null = $state.raw(null);
	const want = async () => {
		refused = null;
		try {
			came = (await load()).default;
		} catch (failure) {
			refused = asRefusal(failure);
		}
	};
	return {
		get part() {
			return came;
		},
		get error() {
			return refused;
		},
		reload: () => void want(),
		want: () => {
			if (!came) void want();
		},
	};
}
