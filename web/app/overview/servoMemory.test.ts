import { expect, test } from 'vitest';
import { hexAddress, hexBytes, isBuffer } from './servoMemory';

test('addresses and bytes are hexadecimal, and a buffer has more bytes than a number', () => {
	expect(hexAddress(4)).toBe('0x04');
	expect(hexAddress(0x5c)).toBe('0x5C');
	expect(hexBytes([0, 255, 16])).toBe('00 FF 10');
	expect([[0, 243, 255, 255], [1, 2, 3, 4, 5]].map(isBuffer)).toEqual([false, true]);
});
