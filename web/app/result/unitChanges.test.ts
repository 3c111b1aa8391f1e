import { expect, it } from 'vitest';
import { isBeyondScatter } from './unitChanges';

it('a value outside the prediction interval is beyond the scatter', () => {
	expect(isBeyondScatter({ present: 3.1, prediction95: [1, 3] })).toBe(true);
	expect(isBeyondScatter({ present: 0.9, prediction95: [1, 3] })).toBe(true);
	expect(isBeyondScatter({ present: 3, prediction95: [1, 3] })).toBe(false);
	expect(isBeyondScatter({ present: 3, prediction95: null })).toBe(false);
});
