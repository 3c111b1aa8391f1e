/**
 * Binary frames of the live stream, little endian: u32 sequence, u32 dropped frames, u32 rows, u32 channels, f64 t0
 * [s], then one f32 column per channel, in the order of the last text frame `channels`.
 */
export interface Frame {
	sequence: number;
	dropped: number;
	rows: number;
	t0_s: number;
	columns: Float32Array[];
}

const HEADER_BYTES = 24;

/** `null` if the bytes are not one whole frame. */
export function decodeFrame(buffer: ArrayBuffer): Frame | null {
	if (buffer.byteLength < HEADER_BYTES) return null;
	const head = new DataView(buffer);
	const rows = head.getUint32(8, true);
	const channels = head.getUint32(12, true);
	if (buffer.byteLength !== HEADER_BYTES + rows * channels * 4) return null;
	const columns = Array.from(
		{ length: channels },
		(_, i) => new Float32Array(buffer, HEADER_BYTES + i * rows * 4, rows),
	);
	return { sequence: head.getUint32(0, true), dropped: head.getUint32(4, true), rows, t0_s: head.getFloat64(16, true), columns };
}
