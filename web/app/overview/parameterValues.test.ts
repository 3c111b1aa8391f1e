import { expect, it } from 'vitest';
import type { ProcedureParameter } from '../api/types';
import { parse, planAddress } from './parameterValues';

const speeds: ProcedureParameter = { name: 'speeds', title: 'Speeds', unit: '', default: 8, min: 2, max: 30, type: 'integer' };

it.each([
	['8', 8, null],
	[' 12 ', 12, null],
	['2.5', 2.5, 'a whole number'],
	['1', 1, 'at least 2.000'],
	['40', 40, 'at most 30.00'],
])('%s', (text, value, error) => expect(parse(speeds, text)).toEqual({ value, error }));

it('says what is needed where there is no number', () => {
	expect(parse(speeds, 'fast').error).toBe('a number');
	expect(parse(speeds, '').error).toBe('a number');
	expect(parse({ ...speeds, type: 'number' }, '2,5')).toEqual({ value: 2.5, error: null });
});

it('plans again what was planned before', () => {
	expect(planAddress('friction', { top_speed_rad_s: 180, loads: [0, 0.5] })).toBe('/?procedure=friction&p.top_speed_rad_s=180&p.loads=0%2C+0.5');
});
