import { keepToken, token } from '../api/token';

/** The daemon requires a token, or refused the present one. Its page contains a mark if a token is required. */
class Entry {
	wanted = $state(!!globalThis.document && 'token' in document.documentElement.dataset && !token());
	private waiting: (() => void)[] = [];

	/** Asks the user for another token and waits for it. */
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
