const hex = (byte: number) => byte.toString(16).toUpperCase().padStart(2, '0');

/** The notation of the document: `0x04`. */
export const hexAddress = (at: number) => `0x${hex(at)}`;

/** Bytes from the lowest address on, at most `most`. */
export function hexBytes(bytes: number[], most = bytes.length): string {
	return bytes.slice(0, most).map(hex).join(' ') + (bytes.length > most ? ' …' : '');
}
