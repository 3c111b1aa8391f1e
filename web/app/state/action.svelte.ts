import { type ApiError, toApiError } from '../api/apiError';

/** An action of the user: one at a time, with the reason of the last refusal. */
export function action() {
	let busy = $state(false);
	let error: ApiError | null = $state.raw(null);
	return {
		get busy() {
			return busy;
		},
		get error() {
			return error;
		},
		async run(work: () => Promise<unknown>): Promise<void> {
			if (busy) return;
			busy = true;
			error = null;
			try {
				await work();
			} catch (failure) {
				error = toApiError(failure);
			}
			busy = false;
		},
	};
}
