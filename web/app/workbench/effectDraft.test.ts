import { describe, expect, it } from 'vitest';
import { splitAtError, definitionOf, draftOf, draftError, effectId, parameterDraft, trialResult, unknownName } from './effectDraft';

const draft = { title: 'My load term', sentence: '', formula: 'tau = a * tanh(velocity / w0)', parameters: [{ name: 'a', unit: '', min: '', max: '1,5' }] };
const place = (text: string, position: number, length: number) => ({ field: 'formula', text, position, length, message: 'wrong' });

describe('an effect of one’s own', () => {
	it('gets its id from its name', () => {
		expect(effectId('  Übermäßig: load ² term! ')).toBe('berm_ig_load_term');
		expect(definitionOf(draft, 'friction').id).toBe('my_load_term');
	});

	it('takes a decimal comma, and no bound where none is typed', () => {
		expect(definitionOf(draft, 'friction').parameters).toEqual([{ name: 'a', unit: '1', min: null, max: 1.5 }]);
	});

	it('survives the way to the daemon and back', () => {
		expect(draftOf(definitionOf(draft, 'friction'))).toEqual({ ...draft, parameters: [{ name: 'a', unit: '1', min: '', max: '1.5' }] });
	});

	it('says what is missing before it asks', () => {
		expect(draftError(draft)).toBeNull();
		expect(draftError({ ...draft, formula: ' ' })).toMatch(/formula/);
		expect(draftError({ ...draft, title: '' })).toBeNull();
		expect(definitionOf({ ...draft, title: '' }, 'friction').id).toBe('unnamed');
		expect(draftError({ ...draft, parameters: [{ ...parameterDraft('a'), min: 'few' }] })).toMatch(/^a: /);
	});

	it('says what the error does under trial', () => {
		const result = (before: number | null, after: number) => trialResult({ before_rms: before, after_rms: after, unit: 'Nm' });
		expect(result(0.002, 0.001)).toEqual({ text: 'Validation error 2.00 mNm → 1.00 mNm (−50 %) ↓ better', helps: true });
		expect(result(0.002, 0.002)).toMatchObject({ text: expect.stringContaining('≈ no gain'), helps: false });
		expect(result(null, 0.001).text).toBe('Validation error 1.00 mNm.');
	});

	it('marks the mistake at its character, counted as people count', () => {
		expect(splitAtError(place('tau = 𝛼 + bb', 10, 2))).toEqual(['tau = 𝛼 + ', 'bb', '']);
		expect(splitAtError(place('tau = (', 7, 0))).toEqual(['tau = (', '', '']);
	});

	it('offers to make an unknown name a parameter, but no function and no sign', () => {
		expect(unknownName(place(draft.formula, 26, 2), draft)).toBe('w0');
		expect(unknownName(place(draft.formula, 6, 1), draft)).toBeNull();
		expect(unknownName(place('tau = foo (1)', 6, 3), draft)).toBeNull();
		expect(unknownName(place('tau = * 2', 6, 1), draft)).toBeNull();
	});
});
