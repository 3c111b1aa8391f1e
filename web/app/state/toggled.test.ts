import { expect, it } from 'vitest';
import { toggled } from './toggled';

it('adds a value at the end, or removes it', () => {
	expect(toggled(['a', 'b'], 'c')).toEqual(['a', 'b', 'c']);
	expect(toggled(['a', 'b'], 'a')).toEqual(['b']);
});
