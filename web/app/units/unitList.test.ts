import { expect, it } from 'vitest';
import { intervalText, readYieldGroup, unitDetails, unitRunsHref, yieldText } from './unitList';

it('names the number of units of a yield', () => {
	expect(yieldText({ fraction: 5 / 6, units: 6 })).toBe('83.3 % of 6 units');
	expect(yieldText({ fraction: 1, units: 1 })).toBe('100.0 % of 1 unit');
	expect(intervalText({ ci95: [0.4365, 0.9699] })).toBe('43.6 to 97.0 %');
});

it('searches for the runs of a unit', () => {
	expect(unitRunsHref('SN123')).toBe('/runs?search=unit%3ASN123');
	expect(unitRunsHref('SN 1')).toBe('/runs?search=unit%3A%22SN%201%22');
});

it('writes what is known of a unit', () => {
	expect(unitDetails({ part: 'P', revision: null, batch: '7' })).toBe('part P, batch 7');
	expect(unitDetails({})).toBe('');
});

it('groups by part if the address names no group', () => {
	expect(['batch', null, 'colour'].map(readYieldGroup)).toEqual(['batch', 'part', 'part']);
});
