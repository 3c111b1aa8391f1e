/**
 * A daemon that listens beyond loopback requires a token. The user enters it once per browser session. Requests send it
 * in a header; the live stream uses the subprotocol header, because a browser cannot set another one there.
 */
const KEPT = 'jointbench.token';

export function token(): string | null {
	return sessionStorage.getItem(KEPT);
}

export function keepToken(text: string): void {
	sessionStorage.setItem(KEPT, text.trim());
}

export function authorization(): Record<string, string> {
	const kept = token();
	return kept ? { authorization: `Bearer ${kept}` } : {};
}
