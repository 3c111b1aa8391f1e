import { keepToken, token } from '../api/token';

/** The daemon requires a token, or refused the present one. Its page contains a mark if a token is required. */
class TokenRequest {
	isOpen = $state(!!globalThis.document && 'token' in document.documentElement.dataset && !token());
	private callbacks: (() => void)[] = [];

	/** Asks the user for another token and waits for it. */
	request(): Promise<void> {
		this.isOpen = true;
		return new Promise((go) => this.callbacks.push(go));
	}

	submit(text: string): void {
		keepToken(text);
		this.isOpen = false;
		for (const go of this.callbacks.splice(0)) go();
	}
}

export const tokenRequest = new TokenRequest();
