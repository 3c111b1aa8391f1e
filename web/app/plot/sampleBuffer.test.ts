import { expect, it } from 'vitest';
import { SampleBuffer } from './sampleBuffer';

/** `rows` samples at 100 Hz of a channel that counts. */
function frame(sequence: number, t0_s: number, rows: number, dropped = 0) {
	const time = Float32Array.from({ length: rows }, (_, i) => i * 0.01);
	const value = Float32Array.from({ length: rows }, (_, i) => t0_s * 100 + i);
	return { sequence, dropped, rows, t0_s, columns: [time, value] };
}

it('is one contiguous window over many frames', () => {
	const tape = new SampleBuffer(['time_s', 'x']);
	tape.push(frame(1, 0, 10));
	tape.push(frame(2, 0.1, 10));
	expect(tape.gaps).toEqual([]);
	const { time, columns } = tape.window(0.045, 0.125);
	expect([...columns[1]!]).toEqual([4, 5, 6, 7, 8, 9, 10, 11, 12, 13]);
	expect(time[0]).toBeCloseTo(0.04, 6);
	expect(tape.latest('x')).toBe(19);
});

it('keeps a missing stretch as a gap', () => {
	const tape = new SampleBuffer(['time_s', 'x']);
	tape.push(frame(1, 0, 10));
	tape.push(frame(9, 3, 10, 7));
	expect(tape.gaps).toHaveLength(1);
	expect(tape.gaps[0]![0]).toBeCloseTo(0.09, 6);
	expect(tape.gaps[0]![1]).toBe(3);
});

it('forgets the oldest, never the newest, and takes nothing twice', () => {
	const tape = new SampleBuffer(['time_s', 'x'], 100);
	for (let i = 0; i < 60; i++) tape.push(frame(i, i * 0.1, 10));
	tape.push(frame(59, 5.9, 10));
	expect(tape.rows).toBeLessThanOrEqual(200);
	expect(tape.rows).toBeGreaterThanOrEqual(100);
	expect(tape.last_s).toBeCloseTo(5.99, 5);
	expect(tape.latest('x')).toBe(599);
});
