import { describe, expect, it } from 'vitest';
import { formatAgainstLimit, formatChange, parseNumber, formatInterval, formatPValue, formatCount, formatEstimate, formatNumber, formatPercent, formatQuantity, scaleFor, formatAllDigits, withOwnDigits } from './number';

describe('numbers as an instrument shows them', () => {
	it.each([
		[0, '0'],
		[12.3456, '12.35'],
		[-0.00123456, '−0.001235'],
		[123456, '123456'],
		[1.5e-5, '1.500·10⁻⁵'],
		[-2e7, '−2.000·10⁷'],
		[Number.NaN, '–'],
		[null, '–'],
	])('%s is %s', (value, text) => expect(formatNumber(value)).toBe(text));

	it('leaves a figure that somebody wrote down as it is', () => {
		expect([0.0406, 177.8, 1.2e-5, 45, -0.5, 31.41592653589793].map(formatAllDigits)).toEqual(['0.0406', '177.8', '1.2·10⁻⁵', '45', '−0.5', '31.41593']);
	});

	it('reads what users type and files contain', () => {
		expect(['0,5', ' −1.2 ', '-3e−5', '7'].map(parseNumber)).toEqual([0.5, -1.2, -3e-5, 7]);
		expect(['', '  ', '1,2,3', 'n/a', '1.2.3'].map(parseNumber)).toEqual(Array.from({ length: 5 }, () => Number.NaN));
	});
	it('has no sign before a change of nothing', () => {
		expect([0.0004, -0.0004, 0, 0.003, 0.17, -0.83].map(formatChange)).toEqual(['0.0 %', '0.0 %', '0.0 %', '+0.3 %', '+17 %', '−83 %']);
	});
	it('has no minus before a share of nothing', () => {
		expect([-0.0004, 0.0004, -0.04].map((share) => formatPercent(share, 1))).toEqual(['0.0 %', '0.0 %', '−4.0 %']);
	});

	it('chooses one prefix by the largest magnitude', () => {
		expect(scaleFor('Nm', 0.0214)).toEqual({ factor: 1e3, unit: 'mNm' });
		expect(scaleFor('Nm', 2)).toEqual({ factor: 1, unit: 'Nm' });
		expect(formatQuantity(1.17e-4, 'rad²')).toBe('117 mrad²');
		expect(formatQuantity(0.417, 'Nm')).toBe('417 mNm');
		expect(formatQuantity(1.507e-4, 'Nm·s/rad')).toBe('151 µNm·s/rad');
		expect(formatQuantity(0.00785, 'V/(°/s)')).toBe('0.00785 V/(°/s)');
		expect(scaleFor('rad', 3e-5)).toEqual({ factor: 1e6, unit: 'µrad' });
		expect(scaleFor('kg·m²', 3e-5).factor).toBe(1);
		expect(formatQuantity(0.02142, 'Nm')).toBe('21.4 mNm');
	});

	it('gives a value and its limit one prefix and equal decimals', () => {
		expect(formatAgainstLimit(-1e-7, 0.62, 'A')).toBe('0 / 620 mA');
		expect([1.234, -12.34, null].map((value) => formatAgainstLimit(value, 30, 'A'))).toEqual(['1.2 / 30.0 A', '−12.3 / 30.0 A', '30.0 A']);
		expect(formatAgainstLimit(10, 0, 'rad/s')).toBe('10.00 / 0.00 rad/s');
	});

	it('gives a value the digits that its interval deserves', () => {
		expect(formatEstimate(0.10123, [0.097, 0.105])).toBe('0.1012');
		expect(formatEstimate(0.10123, [0.05, 0.15])).toBe('0.101');
		expect(formatEstimate(1, [null, null])).toBe('1.000');
		expect(`${formatEstimate(9e-5, [6.1e-5, 1.19e-4])} ${formatInterval([6.1e-5, 1.19e-4])}`).toBe('0.000090 [0.000061, 0.000119]');
		expect(formatInterval([-2e-5, 3e-5])).toBe('[−2.0·10⁻⁵, 3.0·10⁻⁵]');
		expect(formatInterval([0.5, null])).toBe('[0.5000, ?]');
	});

	it('counts one as one', () => {
		expect([0, 1, 1204].map((n) => formatCount(n, 'step'))).toEqual(['0 steps', '1 step', '1,204 steps']);
	});

	it('keeps the digits of a stated value and chooses its prefix', () => {
		expect(withOwnDigits(0.0406, 'Nm/A')).toEqual({ value: '40.6', unit: 'mNm/A' });
		expect(withOwnDigits(1.2e-5, 'kg·m²')).toEqual({ value: '1.2·10⁻⁵', unit: 'kg·m²' });
	});

	it('says chances and shares', () => {
		expect(formatPValue(3e-10)).toBe('p < 10⁻⁹');
		expect(formatPValue(0)).toBe('p < 10⁻¹⁶');
		expect(formatPValue(0.02)).toBe('p = 0.020');
		expect(formatPValue(0.002, true)).toBe('p ≤ 0.002');
		expect(formatPercent(-0.42)).toBe('−42 %');
	});
});
