import { expect, it } from 'vitest';
import type { ProcedureParameter } from '../api/types';
import { defaultText, fieldUnit, fromAddress, inFieldUnit, parseValue, planHref, toAddress } from './parameterValues';

const speeds: ProcedureParameter = { name: 'speeds', title: 'Speeds', unit: '', default: 8, min: 2, max: 30, type: 'integer' };

it.each([
	['8', 8, null],
	[' 12 ', 12, null],
	['2.5', 2.5, 'a whole number'],
	['1', 1, 'at least 2'],
	['40', 40, 'at most 30'],
])('%s', (text, value, error) => expect(parseValue(speeds, text)).toEqual({ value, error }));

it('says what is needed where there is no number', () => {
	expect(parseValue(speeds, 'fast').error).toBe('a number');
	expect(parseValue(speeds, '').error).toBe('a number');
	expect(parseValue({ ...speeds, type: 'number' }, '2,5')).toEqual({ value: 2.5, error: null });
});

it('reads and writes a fraction in per cent', () => {
	const load: ProcedureParameter = { name: 'top_load', title: 'Load', unit: '', default: 0.07, min: 0.05, max: 1, type: 'fraction' };
	expect([fieldUnit(load), defaultText(load), inFieldUnit(load, 0.29), fieldUnit(speeds), inFieldUnit(speeds, 0.29)]).toEqual(['%', '7', 29, '', 0.29]);
	expect(parseValue(load, '57')).toEqual({ value: 0.57, error: null });
	expect([parseValue(load, '0.8').error, parseValue(load, '101').error]).toEqual(['at least 5', 'at most 100']);
	expect([fromAddress(load, '0.8'), fromAddress(load, '7.%'), fromAddress(speeds, '8')]).toEqual(['80', '7.', '8']);
	expect([toAddress(load, '7.'), toAddress(speeds, '8')]).toEqual(['7.%', '8']);
});

it('plans again what was planned before', () => {
	expect(planHref('friction', { top_speed_rad_s: 180, loads: [0, 0.5] })).toBe('/?procedure=friction&p.top_speed_rad_s=180&p.loads=0%2C+0.5');
	expect(planHref('compensation', { reference: [[0, 0], [1, 0.1]] }, 12)).toBe('/?procedure=compensation&p.reference=run%3A12');
	expect(planHref('compensation', { reference: [] }, 12)).toBe('/?procedure=compensation&p.reference=');
});
