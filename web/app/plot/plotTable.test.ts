import { expect, it } from 'vitest';
import type { Curve } from './chart';
import { tableHead, visibleRows } from './plotTable';

it('gives the rows that are in view, and nothing for what is missing', () => {
	const curves = [
		{ label: 'set', unit: 'Nm' },
		{ label: 'count', unit: '' },
	] as Curve[];
	const data = [Float64Array.of(0, 1, 2, 3), [5, null, 7, 8], Float32Array.of(1, 2, Number.NaN, 4)];
	expect(tableHead('time [s]', curves)).toEqual(['time [s]', 'set [Nm]', 'count']);
	expect(visibleRows([0.5, 2], curves, data)).toEqual([[1, null, 2], [2, 7, null]]);
	expect(visibleRows(null, curves, data)).toHaveLength(4);
});
