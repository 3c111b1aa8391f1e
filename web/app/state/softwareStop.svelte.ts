import { api } from '../api/client';
import { toApiError } from '../api/apiError';

/** If a software stop is not acknowledged within this time, the page refers users to the hardware stop. */
export const ACKNOWLEDGE_LIMIT_MS = 300;
const AGAIN_MS = 400;

class SoftwareStop {
	/** Time from the press to the daemon's message that the bench has accepted the stop. */
	acknowledged_ms: number | null = $state(null);
	/** No acknowledgement in time: the page shows a full-size warning. */
	overdue = $state(false);
	pressed = $state(false);
	fault: string | null = $state(null);

	/** Stops without a confirmation dialog. Retries until the daemon answers or the user closes the warning. */
	async press(bench: string): Promise<void> {
		const begin = performance.now();
		this.acknowledged_ms = null;
		this.fault = null;
		this.pressed = true;
		const late = setTimeout(() => (this.overdue = true), ACKNOWLEDGE_LIMIT_MS);
		while (this.pressed) {
			try {
				await api.stopBench(bench);
				// The page may have been busy when the answer arrived.
				const [answer] = performance.getEntriesByType('resource').filter((one) => one.startTime >= begin && one.name.endsWith('/stop')).slice(-1);
				const end = answer instanceof PerformanceResourceTiming ? answer.responseEnd : performance.now();
				this.acknowledged_ms = end - begin;
				this.pressed = false;
				if (this.acknowledged_ms <= ACKNOWLEDGE_LIMIT_MS) this.overdue = false;
			} catch (failure) {
				this.fault = toApiError(failure).message;
				await new Promise((resolve) => setTimeout(resolve, AGAIN_MS));
			}
		}
		clearTimeout(late);
	}

	/** No daemon or bench can receive the stop. */
	cannotSend(why: string): void {
		this.fault = why;
		this.acknowledged_ms = null;
		this.overdue = true;
	}

	dismiss(): void {
		this.overdue = false;
		this.pressed = false;
	}
}

export const softwareStop = new SoftwareStop();
