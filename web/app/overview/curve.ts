import { parseNumber } from '../format/number';

/** Set-points over time: pairs of a time in s and a value. */
export type Curve = [number, number][];

/** The points of a curve among the settings of a run. */
export const isCurve = (value: unknown): value is Curve => Array.isArray(value) && value.length > 0 && value.every((point) => Array.isArray(point) && point.length === 2);

/**
 * Reads the first two columns of a text: time in s and value. Lines before the first numbers are titles or names.
 * `error`: what is wrong, with its line.
 */
export function parseCurve(text: string): { points: Curve; error: string | null } {
	const points: Curve = [];
	const lines = text.replace(/^\uFEFF/, '').split(/\r\n|\r|\n/);
	for (const [index, line] of lines.entries()) {
		if (line.trim() === '' || line.trim().startsWith('#')) continue;
		const cells = line.trim().split(/;|\t/.test(line) ? /\s*[;\t]\s*/ : /\s*,\s*|\s+/);
		const [time, value] = cells.slice(0, 2).map(parseNumber);
		if (time !== undefined && value !== undefined && Number.isFinite(time) && Number.isFinite(value)) points.push([time, value]);
		else if (points.length > 0) return { points, error: `line ${index + 1}: two numbers are needed, time in s and value` };
	}
	return { points, error: points.length < 2 ? 'the file needs two columns of numbers: time in s and value' : null };
}
