import type { EffectCheck, EffectDefinition, FormulaPosition } from '../api/types';
import { formatChange, formatQuantity, parseNumber } from '../format/number';
import { classifyGain, gainText } from './versionTree';

/** One parameter as typed by the user. */
export interface ParameterDraft {
	name: string;
	unit: string;
	min: string;
	max: string;
}

/** A user's effect as typed by the user. */
export interface EffectDraft {
	title: string;
	sentence: string;
	formula: string;
	parameters: ParameterDraft[];
}

export const parameterDraft = (name = ''): ParameterDraft => ({ name, unit: '', min: '', max: '' });

/** The id of an effect from its name: `My load term` → `my_load_term`. */
export function effectId(title: string): string {
	return title
		.toLowerCase()
		.replace(/[^a-z0-9]+/g, '_')
		.replace(/^_+|_+$/g, '');
}

/** A bound as typed; `null` for an empty text, NaN for an invalid number. */
const bound = (text: string): number | null => (text.trim() === '' ? null : parseNumber(text));

/** The first error that the page finds itself, before a request to the daemon. */
export function draftError(draft: EffectDraft): string | null {
	if (draft.formula.trim() === '') return 'Write the formula.';
	for (const p of draft.parameters) {
		const [min, max] = [bound(p.min), bound(p.max)];
		if (Number.isNaN(min) || Number.isNaN(max)) return `${p.name}: a bound is a number, or nothing.`;
	}
	return null;
}

/** An effect without a name is checked and tried under the name `unnamed`. */
export function definitionOf(draft: EffectDraft, kind: string): EffectDefinition {
	return {
		id: effectId(draft.title) || 'unnamed',
		kind,
		title: draft.title.trim() || 'unnamed',
		sentence: draft.sentence.trim(),
		formula: draft.formula,
		parameters: draft.parameters.map((p) => ({ name: p.name.trim(), unit: p.unit.trim() || '1', min: bound(p.min), max: bound(p.max) })),
	};
}

export function draftOf(definition: EffectDefinition): EffectDraft {
	const text = (value: number | null | undefined) => (value == null ? '' : String(value));
	return {
		title: definition.title || definition.id.replaceAll('_', ' '),
		sentence: definition.sentence ?? '',
		formula: definition.formula,
		parameters: definition.parameters.map((p) => ({ name: p.name, unit: p.unit ?? '', min: text(p.min), max: text(p.max) })),
	};
}

/** Splits a text into three parts: before, at and after the error. Positions count characters, not code units. */
export function splitAtError({ text, position, length }: FormulaPosition): [string, string, string] {
	const letters = [...text];
	const part = (from: number, to?: number) => letters.slice(from, to).join('');
	return [part(0, position), part(position, position + length), part(position + length)];
}

/** An unknown name in the formula may become a parameter. */
export function unknownName(place: FormulaPosition | null, draft: EffectDraft): string | null {
	if (place?.field !== 'formula') return null;
	const [, name, rest] = splitAtError(place);
	const isCall = /^\s*\(/.test(rest);
	return /^[a-z]\w*$/i.test(name) && !isCall && !draft.parameters.some((p) => p.name === name) ? name : null;
}

/** What an effect under trial does to the error: before and after in one unit, and the change. */
export function trialResult({ before_rms: before, after_rms: after, unit }: NonNullable<EffectCheck['error']>): { text: string; helps: boolean } {
	if (before == null) return { text: `Validation error ${formatQuantity(after, unit)}.`, helps: true };
	const share = before > 0 ? 1 - after / before : 0;
	return { text: `Validation error ${formatQuantity(before, unit)} → ${formatQuantity(after, unit)} (${formatChange(-share)}) ${gainText(share)}`, helps: classifyGain(share) === 'better' };
}
