import { expect, it } from 'vitest';
import type { Curve } from './chart';
import { numbers } from './take';

it('gives the rows that are in view, and nothing for what is missing', () => {
	const curves = [
		{ label: 'set', unit: 'Nm' },
		{ label: 'count', unit: '' },
	] as Curve[];
	const data = [Float64Array.of(0, 1, 2, 3), [5, null, 7, 8], Float32Array.of(1, 2, Number.NaN, 4)];
	expect(numbers('time [s]', curves, data, [0.5, 2])).toBe('time [s],set [Nm],count\n1,,2\n2,7,\n');
	expect(numbers('time [s]', curves, data, null).split('\n')).toHaveLength(6);
});
