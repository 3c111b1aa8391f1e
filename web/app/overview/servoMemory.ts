const hex = (byte: number) => byte.toString(16).toUpperCase().padStart(2, '0');

/** The notation of the document: `0x04`. */
export const hexAddress = (at: number) => `0x${hex(at)}`;

/** Bytes from the lowest address on. */
export const hexBytes = (bytes: number[]) => bytes.map(hex).join(' ');

/** More bytes than a number has: they have a line of their own. */
export const isBuffer = (bytes: number[]) => bytes.length > 4;
