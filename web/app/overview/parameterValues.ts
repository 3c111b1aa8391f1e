import { formatAllDigits, parseNumber } from '../format/number';
import type { ProcedureParameter } from '../api/types';
import { isCurve } from './curve';

export interface ParsedValue {
	value: number;
	/** Why the text cannot be sent. */
	error: string | null;
}

type OfField = Pick<ProcedureParameter, 'type' | 'unit'>;

/** The unit in which a person reads and enters a setting: per cent for a fraction. */
export const fieldUnit = ({ type, unit }: OfField): string => (type === 'fraction' ? '%' : unit);

/** A value of a setting in the unit of its field, without the rounding of the multiplication: 0.07 is 7. */
export const inFieldUnit = (field: OfField | undefined, value: unknown): unknown =>
	field?.type === 'fraction' && typeof value === 'number' ? Number((100 * value).toPrecision(12)) : value;

/** Converts the user's text to the number of the procedure. */
export function parseValue(field: ProcedureParameter, text: string): ParsedValue {
	const { type } = field;
	const [entered, min, max] = [parseNumber(text), Number(inFieldUnit(field, field.min)), Number(inFieldUnit(field, field.max))];
	return { value: type === 'fraction' ? entered / 100 : entered, error: wrong() };

	function wrong(): string | null {
		if (!Number.isFinite(entered)) return 'a number';
		if (type === 'integer' && !Number.isInteger(entered)) return 'a whole number';
		if (entered < min) return `at least ${formatAllDigits(min)}`;
		return entered > max ? `at most ${formatAllDigits(max)}` : null;
	}
}

/** A value as the text of its field. */
export function valueText(value: unknown): string {
	if (value === null || value === undefined) return '';
	return Array.isArray(value) ? value.join(', ') : String(value);
}

/** The default of a setting as the text of its field. */
export const defaultText = (field: ProcedureParameter): string => valueText(inFieldUnit(field, field.default));

/** The text of a field in an address: the value of the procedure, or what a person typed in per cent. */
export function fromAddress(field: ProcedureParameter, text: string): string {
	if (field.type !== 'fraction') return text;
	const value = parseNumber(text);
	return text.endsWith('%') ? text.slice(0, -1) : Number.isFinite(value) ? valueText(inFieldUnit(field, value)) : text;
}

/** Reverses `fromAddress`. */
export const toAddress = ({ type }: ProcedureParameter, text: string): string => (type === 'fraction' ? `${text}%` : text);

/**
 * The bench page with a procedure and its settings filled in; it starts nothing. An address has no room for the points
 * of a curve: the page takes them from the run.
 */
export function planHref(procedure: string, parameters: Record<string, unknown>, run?: number): string {
	const text = (value: unknown) => (isCurve(value) ? `run:${run}` : valueText(value));
	const settings = Object.entries(parameters).map(([name, value]) => [`p.${name}`, text(value)]);
	return `/?${new URLSearchParams([['procedure', procedure], ...settings] as [string, string][]).toString()}`;
}
