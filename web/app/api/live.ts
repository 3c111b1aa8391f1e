import { BASE } from './client';
import { type Frame, decodeFrame } from './frame';
import { token } from './token';
import type { LiveMessage } from './types';

export interface LiveHandlers {
	message: (message: LiveMessage) => void;
	frame: (frame: Frame) => void;
	/** The connection is open (true) or lost (false). */
	connected: (up: boolean) => void;
}

const FIRST_RETRY_MS = 300;
const LAST_RETRY_MS = 3000;

/** Keeps one WebSocket to the daemon open for the lifetime of the page. Returns a function that closes it. */
export function connectLive(handlers: LiveHandlers): () => void {
	let socket: WebSocket | null = null;
	let wait_ms = FIRST_RETRY_MS;
	let timer: ReturnType<typeof setTimeout> | undefined;
	let closed = false;

	const open = () => {
		const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
		const storedToken = token();
		// Addresses are logged in transit, so the token is a subprotocol, which may not contain brackets.
		const offered = storedToken ? ['jointbench', `token.${encodeURIComponent(storedToken).replace(/[()]/g, (bracket) => `%${bracket.charCodeAt(0).toString(16)}`)}`] : [];
		socket = new WebSocket(`${scheme}://${location.host}${BASE}/events`, offered);
		socket.binaryType = 'arraybuffer';
		socket.onopen = () => {
			wait_ms = FIRST_RETRY_MS;
			handlers.connected(true);
		};
		socket.onmessage = ({ data }: MessageEvent<string | ArrayBuffer>) => {
			if (typeof data === 'string') return handlers.message(JSON.parse(data) as LiveMessage);
			const frame = decodeFrame(data);
			if (frame) handlers.frame(frame);
		};
		socket.onclose = () => {
			if (closed) return;
			handlers.connected(false);
			timer = setTimeout(open, wait_ms);
			wait_ms = Math.min(LAST_RETRY_MS, wait_ms * 1.6);
		};
	};
	open();
	return () => {
		closed = true;
		clearTimeout(timer);
		socket?.close();
	};
}
