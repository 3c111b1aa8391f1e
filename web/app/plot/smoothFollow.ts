/** Delay behind the newest sample: frames arrive irregularly, but the plot must scroll smoothly. */
const DELAY_MS = 100;
/** [s] Distance below which the end of the stream is reached. */
const END_S = 1e-4;

/**
 * End time of live plots, `passed_ms` after they ended at `shown_s`. It follows the newest sample smoothly at any rate
 * of the bench.
 */
export function smoothFollow(shown_s: number | null, newest_s: number, passed_ms: number): number {
	if (shown_s === null) return newest_s;
	const left_s = (newest_s - shown_s) * Math.exp(-passed_ms / DELAY_MS);
	return left_s > END_S ? newest_s - left_s : newest_s;
}
