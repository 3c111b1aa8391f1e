import { expect, it } from 'vitest';
import { isOn } from './trace';

it('knows where a dash is on', () => {
	expect([0, 6.9, 7, 10.9, 11, 18].map((x) => isOn([7, 4], x))).toEqual([true, true, false, false, true, false]);
	expect([0, 10, 13, 15].map((x) => isOn([9, 3, 2, 3], x))).toEqual([true, false, true, false]);
});
