import { expect, it } from 'vitest';
import { hoverStyle } from './hoverPlace';

it('a hover label is on the side of the pointer with more room, and wraps there', () => {
	const size = [400, 200] as const;
	expect(hoverStyle({ at: [40, 30], size })).toBe('left:0;top:0;translate:52px 42px;max-width:348px');
	expect(hoverStyle({ at: [390, 30], size })).toBe('right:0;top:0;translate:-22px 42px;max-width:378px');
	expect(hoverStyle({ at: [200, 180], size })).toBe('left:0;bottom:0;translate:212px -32px;max-width:188px');
});
