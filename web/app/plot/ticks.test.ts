import { expect, it } from 'vitest';
import { tickText, tickTexts, ticks } from './ticks';

it('finds round positions', () => {
	expect(ticks(0, 1, 5)).toEqual([0, 0.2, 0.4, 0.6, 0.8, 1]);
	expect(ticks(-7, 7, 3)).toEqual([-5, 0, 5]);
	// A single step of 200 would give only one position.
	expect(ticks(-187, 187, 2)).toEqual([-100, 0, 100]);
	expect(ticks(0.1, 14.9, 2)).toEqual([2.5, 5, 7.5, 10, 12.5]);
	expect(ticks(3, 3, 5)).toEqual([3]);
	expect(ticks(Number.NaN, 1, 5)).toEqual([]);
});

it('writes the ticks of one axis with equal decimals', () => {
	expect(tickTexts([28.65, 28.7, 28.75])).toEqual(['28.65', '28.70', '28.75']);
	expect(tickTexts([-0.5, 0, 0.5])).toEqual(['−0.5', '0.0', '0.5']);
	expect(tickTexts([0, 2e-5])).toEqual(['0', '2.0·10⁻⁵']);
});

it('writes them without needless zeros', () => {
	expect([0, 0.2, -50, 2e-5].map(tickText)).toEqual(['0', '0.2', '−50', '2.0·10⁻⁵']);
});
