import { formatAllDigits, parseNumber } from '../format/number';
import type { ProcedureParameter } from '../api/types';
import { isCurve } from './curve';

export interface ParsedValue {
	value: number;
	/** Why the text cannot be sent. */
	error: string | null;
}

/** Converts the user's text to the number of the procedure. */
export function parseValue({ type, min, max }: ProcedureParameter, text: string): ParsedValue {
	const value = parseNumber(text);
	return { value, error: wrong() };

	function wrong(): string | null {
		if (!Number.isFinite(value)) return 'a number';
		if (type === 'integer' && !Number.isInteger(value)) return 'a whole number';
		if (value < min) return `at least ${formatAllDigits(min)}`;
		return value > max ? `at most ${formatAllDigits(max)}` : null;
	}
}

/** A value as the text of its field. */
export function valueText(value: unknown): string {
	if (value === null || value === undefined) return '';
	return Array.isArray(value) ? value.join(', ') : String(value);
}

/**
 * The bench page with a procedure and its settings filled in; it starts nothing. An address has no room for the points
 * of a curve: the page takes them from the run.
 */
export function planHref(procedure: string, parameters: Record<string, unknown>, run?: number): string {
	const text = (value: unknown) => (isCurve(value) ? `run:${run}` : valueText(value));
	const settings = Object.entries(parameters).map(([name, value]) => [`p.${name}`, text(value)]);
	return `/?${new URLSearchParams([['procedure', procedure], ...settings] as [string, string][]).toString()}`;
}
