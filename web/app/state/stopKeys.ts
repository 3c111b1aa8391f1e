/** Longest time between two presses of Esc. */
export const DOUBLE_PRESS_MS = 900;

/** Meaning of a key: stop, a request for a second Esc, or none. */
export type StopKey = 'stop' | 'again' | null;

type Press = Pick<KeyboardEvent, 'key' | 'code' | 'ctrlKey' | 'shiftKey' | 'repeat' | 'timeStamp'>;

/**
 * The software stop by keyboard. Ctrl + Shift + Space always stops, because typing cannot produce this chord. Esc twice
 * stops only while the bench is active, and only if neither press leaves a field or closes a menu or dialog.
 */
export class StopKeys {
	#first_ms = -Infinity;

	/** `active`: the bench runs or moves. `closes`: Esc has another function at its target. */
	press(event: Press, active: boolean, closes: boolean): StopKey {
		if (event.repeat) return null;
		if (event.code === 'Space' && event.ctrlKey && event.shiftKey) return 'stop';
		if (event.key !== 'Escape' || !active || closes) {
			this.#first_ms = -Infinity;
			return null;
		}
		const twice = event.timeStamp - this.#first_ms < DOUBLE_PRESS_MS;
		this.#first_ms = twice ? -Infinity : event.timeStamp;
		return twice ? 'stop' : 'again';
	}
}

/** Fields, and elements that handle Esc themselves (`data-escape`). */
const OWN_ESCAPE = 'input, textarea, select, [contenteditable], form[aria-label] *, button[data-escape], details[open][data-escape] *';

/** Whether Esc at `target` leaves a field, or closes a menu or dialog. */
export function escapeCloses(target: EventTarget | null): boolean {
	return (target instanceof Element && target.closest(OWN_ESCAPE) !== null) || document.querySelector('dialog[open]') !== null;
}
