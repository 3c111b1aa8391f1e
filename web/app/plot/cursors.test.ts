import { expect, it } from 'vitest';
import { nearestRow, readCursors, initialCursors, writeCursors } from './cursors';

it('keeps two cursors in the address, whichever is left', () => {
	expect(readCursors(writeCursors([3.25, 1]))).toEqual([3.25, 1]);
	expect([readCursors(null), readCursors('1'), readCursors('1:x')]).toEqual([null, null, null]);
	expect(initialCursors([3, 12])).toEqual([6, 9]);
});

it('finds the row next to a moment', () => {
	expect([-1, 0.4, 0.6, 9].map((at) => nearestRow([0, 1, 2], at))).toEqual([0, 0, 1, 2]);
	expect(nearestRow([], 1)).toBeNull();
});
