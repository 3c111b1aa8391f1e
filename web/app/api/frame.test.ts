import { expect, it } from 'vitest';
import { decodeFrame } from './frame';

function encode(rows: number, columns: number[][], t0_s = 5): ArrayBuffer {
	const bytes = new ArrayBuffer(24 + rows * columns.length * 4);
	const view = new DataView(bytes);
	[7, 2, rows, columns.length].forEach((value, i) => view.setUint32(i * 4, value, true));
	view.setFloat64(16, t0_s, true);
	columns.flat().forEach((value, i) => view.setFloat32(24 + i * 4, value, true));
	return bytes;
}

it('reads header and columns', () => {
	const frame = decodeFrame(encode(2, [[0, 0.5], [3, 4]]));
	expect(frame).toMatchObject({ sequence: 7, dropped: 2, rows: 2, t0_s: 5 });
	expect(frame?.columns.map((column) => [...column])).toEqual([[0, 0.5], [3, 4]]);
});

it('refuses what is not one whole frame', () => {
	const whole = encode(2, [[0, 0.5], [3, 4]]);
	expect(decodeFrame(whole.slice(0, -4))).toBeNull();
	expect(decodeFrame(new ArrayBuffer(10))).toBeNull();
});
