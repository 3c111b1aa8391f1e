/**
 * A daemon that listens beyond loopback requires a token. The user enters it once per browser session. Requests send it
 * in a header; the live stream uses the subprotocol header, because a browser cannot set another one there.
 */
const STORAGE_KEY = 'jointbench.token';

export function token(): string | null {
	return sessionStorage.getItem(STORAGE_KEY);
}

export function keepToken(text: string): void {
	sessionStorage.setItem(STORAGE_KEY, text.trim());
}

export function authorization(): Record<string, string> {
	const stored = token();
	return stored ? { authorization: `Bearer ${stored}` } : {};
}
