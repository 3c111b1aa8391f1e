import { untrack } from 'svelte';

/** One map of keys for the whole page. The help sheet is drawn from it, so it cannot tell of a key that does nothing. */
export interface Key {
	/** As `KeyboardEvent.key` gives it. */
	key: string;
	/** What it does, for the help sheet. */
	does: string;
	run: () => void;
}

class Keys {
	groups: { name: string; keys: Key[] }[] = $state.raw([]);

	/** Adds a group until the returned function is called. A later group wins over an earlier one. */
	bind(name: string, keys: Key[]): () => void {
		const group = { name, keys };
		this.groups = [...untrack(() => this.groups), group];
		return () => {
			this.groups = untrack(() => this.groups).filter((other) => other !== group);
		};
	}

	press(event: KeyboardEvent): void {
		if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
		if (isTyping(event.target) || (event.key === ' ' && isPressed(event.target))) return;
		for (const group of [...this.groups].reverse()) {
			const key = group.keys.find((candidate) => candidate.key === event.key);
			if (!key) continue;
			event.preventDefault();
			return key.run();
		}
	}
}

function isTyping(target: EventTarget | null): boolean {
	const element = target instanceof HTMLElement ? target : null;
	// A box to tick takes no letters; in a form with a name of its own, such as an editor, all keys are its own.
	return !!element && (element.isContentEditable || element.closest('form[aria-label]') !== null || element.matches('textarea, select, input:not([type=checkbox], [type=radio], [type=range])'));
}

/** Space is its own key there. */
const isPressed = (target: EventTarget | null) => target instanceof HTMLElement && target.matches('button, summary, input');

export const keys = new Keys();
