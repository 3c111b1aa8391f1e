import { expect, it } from 'vitest';
import { scaled, speedScale } from './speed';

it('reads speeds in rpm, and nothing else', () => {
	expect(speedScale('rad/s', true).factor * 2 * Math.PI).toBeCloseTo(60, 12);
	expect(speedScale('rad/s²', true)).toEqual({ factor: 1, unit: 'rad/s²' });
	expect(speedScale('rad/s', false)).toEqual({ factor: 1, unit: 'rad/s' });
});

it('leaves gaps as they are, and a column that stays in its unit untouched', () => {
	const column = Float32Array.of(1, 2);
	expect(scaled(column, { factor: 1, unit: 'Nm' })).toBe(column);
	expect(scaled([1, null], { factor: 2, unit: 'rpm' })).toEqual([2, null]);
});
