import { expect, test } from 'vitest';
import { hexAddress, hexBytes } from './servoMemory';

test('addresses and bytes are hexadecimal, and long rows are cut', () => {
	expect(hexAddress(4)).toBe('0x04');
	expect(hexAddress(0x5c)).toBe('0x5C');
	expect(hexBytes([0, 255, 16])).toBe('00 FF 10');
	expect(hexBytes([1, 2, 3, 4, 5], 4)).toBe('01 02 03 04 …');
});
