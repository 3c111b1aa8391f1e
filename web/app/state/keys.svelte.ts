import { untrack } from 'svelte';

/** One map of keys for the whole page. The help sheet is drawn from it, so it lists only existing keys. */
export interface Key {
	/** The value of `KeyboardEvent.key`. */
	key: string;
	/** Description for the help sheet. */
	description: string;
	run: () => void;
}

class Keys {
	groups: { name: string; keys: Key[] }[] = $state.raw([]);

	/** Adds a group until the returned function is called. A later group has priority over an earlier one. */
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
	// A checkbox receives no letters; a form with its own name, such as an editor, receives all keys.
	return !!element && (element.isContentEditable || element.closest('form[aria-label]') !== null || element.matches('textarea, select, input:not([type=checkbox], [type=radio], [type=range])'));
}

/** These elements use Space themselves. */
const isPressed = (target: EventTarget | null) => target instanceof HTMLElement && target.matches('button, summary, input');

export const keys = new Keys();
