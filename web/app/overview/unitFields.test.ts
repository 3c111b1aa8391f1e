import { expect, it } from 'vitest';
import { fieldAfter, foldedText, loadUnitTexts, saveUnitTexts, unitOf, type UnitTexts } from './unitFields';

function storage(initial?: string) {
	const stored = new Map(initial === undefined ? [] : [['jointbench.unit', initial]]);
	return { getItem: (key: string) => stored.get(key) ?? null, setItem: (key: string, value: string) => void stored.set(key, value) };
}

const texts: UnitTexts = { serial: ' SN123 ', part: 'P', revision: ' ', batch: '7', operator: 'A. Smith' };

it('sends what is filled in', () => {
	expect(unitOf(texts)).toEqual({ unit: { serial: 'SN123', part: 'P', batch: '7' }, operator: 'A. Smith' });
	expect(unitOf({ ...texts, operator: '' })).toEqual({ unit: { serial: 'SN123', part: 'P', batch: '7' } });
});

it('starts a run without a unit if no serial number is entered', () => {
	expect(unitOf({ ...texts, serial: ' ' })).toEqual({ operator: 'A. Smith' });
	expect(unitOf(loadUnitTexts(storage()))).toEqual({});
});

it('stores everything except the serial number', () => {
	const browser = storage();
	saveUnitTexts(texts, browser);
	expect(browser.getItem('jointbench.unit')).not.toContain('SN123');
	expect(loadUnitTexts(browser)).toEqual({ ...texts, serial: '' });
});

it.each(['', 'null', '7', '{"part": 7}', 'no JSON'])('bears a damaged storage: %s', (stored) => {
	expect(loadUnitTexts(storage(stored))).toEqual({ serial: '', part: '', revision: '', batch: '', operator: '' });
});

it('moves to the next field with Enter and stays in the last field', () => {
	expect((['serial', 'part', 'revision', 'batch', 'operator'] as const).map(fieldAfter)).toEqual(['part', 'revision', 'batch', 'operator', 'operator']);
});

it('shows the folded fields in a line', () => {
	expect(foldedText(texts)).toBe('part P · batch 7 · operator A. Smith');
	expect(foldedText(loadUnitTexts(storage()))).toBe('Part, revision, batch, operator');
});
