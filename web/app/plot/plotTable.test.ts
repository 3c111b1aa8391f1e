import { expect, it } from 'vitest';
import type { Curve } from './chart';
import { headOf, rowsIn } from './plotTable';

it('gives the rows that are in view, and nothing for what is missing', () => {
	const curves = [
		{ label: 'set', unit: 'Nm' },
		{ label: 'count', unit: '' },
	] as Curve[];
	const data = [Float64Array.of(0, 1, 2, 3), [5, null, 7, 8], Float32Array.of(1, 2, Number.NaN, 4)];
	expect(headOf('time [s]', curves)).toEqual(['time [s]', 'set [Nm]', 'count']);
	expect(rowsIn([0.5, 2], curves, data)).toEqual([[1, null, 2], [2, 7, null]]);
	expect(rowsIn(null, curves, data)).toHaveLength(4);
});
