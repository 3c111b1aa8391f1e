import { expect, it } from 'vitest';
import { alternateSteps } from './backdrop';

it('shades every other step within the view', () => {
	expect(alternateSteps([0, 1, 2, 3], [0.5, 3.5], 300)).toEqual([[1, 2], [3, 3.5]]);
});

it('shades nothing where steps are too narrow, or where there is only one', () => {
	expect(alternateSteps(Array.from({ length: 100 }, (_, i) => i), [0, 100], 200)).toEqual([]);
	expect(alternateSteps([0], [0, 10], 200)).toEqual([]);
});
