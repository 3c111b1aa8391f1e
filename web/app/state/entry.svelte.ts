import { keepToken, token } from '../api/token';

/** The daemon wants a token that it was not given, or does not know the one it was given. Its page says so where it asks for one. */
class Entry {
	wanted = $state(!!globalThis.document && 'token' in document.documentElement.dataset && !token());
	private waiting: (() => void)[] = [];

	/** Asks a person for another token, and waits for it. */
	ask(): Promise<void> {
		this.wanted = true;
		return new Promise((go) => this.waiting.push(go));
	}

	give(text: string): void {
		keepToken(text);
		this.wanted = false;
		for (const go of this.waiting.splice(0)) go();
	}
}

export const entry = new Entry();
