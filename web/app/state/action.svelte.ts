import { type Refusal, asRefusal } from '../api/apiError';

/** An action of the user: one at a time, with the reason of the last refusal. */
export function action() {
	let busy = $state(false);
	let error: Refusal | null = $state.raw(null);
	return {
		get busy() {
			return busy;
		},
		get error() {
			return error;
		},
		async act(work: () => Promise<unknown>): Promise<void> {
			if (busy) return;
			busy = true;
			error = null;
			try {
				await work();
			} catch (failure) {
				error = asRefusal(failure);
			}
			busy = false;
		},
	};
}
