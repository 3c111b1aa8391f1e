/** How soon the second press of Esc has to follow the first. */
export const TWICE_MS = 900;

/** What a key asks for: the stop, a second Esc, or nothing. */
export type StopKey = 'stop' | 'again' | null;

type Press = Pick<KeyboardEvent, 'key' | 'code' | 'ctrlKey' | 'shiftKey' | 'repeat' | 'timeStamp'>;

/**
 * The software stop by keyboard. Ctrl + Shift + Space always stops: typing cannot produce this chord. Esc twice stops only
 * while the bench is active, and only where neither press leaves a field or closes a menu or dialog.
 */
export class StopKeys {
	#first_ms = -Infinity;

	/** `active`: a run or motion is on. `closes`: Esc has a meaning of its own where it is pressed. */
	press(event: Press, active: boolean, closes: boolean): StopKey {
		if (event.repeat) return null;
		if (event.code === 'Space' && event.ctrlKey && event.shiftKey) return 'stop';
		if (event.key !== 'Escape' || !active || closes) {
			this.#first_ms = -Infinity;
			return null;
		}
		const twice = event.timeStamp - this.#first_ms < TWICE_MS;
		this.#first_ms = twice ? -Infinity : event.timeStamp;
		return twice ? 'stop' : 'again';
	}
}

/** Fields, and elements that handle Esc themselves (`data-escape`). */
const OWN_ESCAPE = 'input, textarea, select, [contenteditable], form[aria-label] *, button[data-escape], details[open][data-escape] *';

/** Whether Esc pressed at `target` leaves a field, or closes a menu or dialog. */
export function escapeCloses(target: EventTarget | null): boolean {
	return (target instanceof Element && target.closest(OWN_ESCAPE) !== null) || document.querySelector('dialog[open]') !== null;
}
