/**
 * A daemon that listens beyond loopback wants a token. A person gives it once for each browser session; it goes into a
 * header: that of the subprotocol where a browser can set no other (the live stream).
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
