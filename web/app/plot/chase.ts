/** A tenth of a second behind the newest sample: frames come in gusts, and what scrolls should not. */
const BEHIND_MS = 100;
/** [s] Nearer than this it has arrived. */
const THERE_S = 1e-4;

/** Where live plots end, `passed_ms` after they ended at `shown_s`: it follows the newest sample smoothly at any pace of the bench. */
export function chase(shown_s: number | null, newest_s: number, passed_ms: number): number {
	if (shown_s === null) return newest_s;
	const left_s = (newest_s - shown_s) * Math.exp(-passed_ms / BEHIND_MS);
	return left_s > THERE_S ? newest_s - left_s : newest_s;
}
