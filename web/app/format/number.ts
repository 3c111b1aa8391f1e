/** Numbers in the style of instruments: few digits, true minus sign, separate unit. */

const MINUS = '−';

/** A number as text with a decimal comma or a true minus sign, in the notation of the daemon. */
export const plainNumber = (text: string): string => text.trim().replace(',', '.').replaceAll(MINUS, '-');

/** A number as typed by a user or read from a file. NaN for any other text. */
export function parseNumber(text: string): number {
	const plain = plainNumber(text);
	return plain === '' ? Number.NaN : Number(plain);
}

/** `digits` significant digits, no exponent from `least` to 1e6. */
export function formatNumber(value: number | null | undefined, digits = 4, least = 1e-4): string {
	if (value == null || !Number.isFinite(value)) return '–';
	if (value === 0) return '0';
	const size = Math.abs(value);
	if (size < least || size >= 1e6) return exponent(value, Math.max(0, digits - 1));
	return value.toFixed(decimalsFor(size, digits)).replace('-', MINUS);
}

const decimalsFor = (size: number, digits: number): number => Math.min(8, Math.max(0, digits - 1 - Math.floor(Math.log10(size))));

function exponent(value: number, decimals?: number): string {
	const [mantissa = '', power = ''] = value.toExponential(decimals).split('e');
	return `${mantissa.replace('-', MINUS)}·10${superscript(Number(power))}`;
}

/** A number with its own digits, at most seven. */
export function formatAllDigits(value: number): string {
	const own = Number(value.toPrecision(7));
	const size = Math.abs(own);
	if (size === 0 || (size >= 1e-4 && size < 1e6)) return String(own).replace('-', MINUS);
	return exponent(own);
}

/** A value with its own digits and a prefix: `40.6` and `mNm/A`. */
export function withOwnDigits(value: number, unit: string): { value: string; unit: string } {
	const scale = scaleFor(unit, value);
	return { value: formatAllDigits(value * scale.factor), unit: scale.unit };
}

const RAISED = '⁰¹²³⁴⁵⁶⁷⁸⁹';

function superscript(power: number): string {
	const digits = String(Math.abs(power)).replace(/\d/g, (digit) => RAISED[Number(digit)] ?? '');
	return power < 0 ? `⁻${digits}` : digits;
}

export interface Scale {
	factor: number;
	unit: string;
}

/**
 * Units that accept a prefix: `mNm·s/rad`, `µrad`. Only stiffnesses and rates accept large prefixes; `krad/s` is not in
 * use.
 */
const SMALL = /^(Nm|rad)|^[NAVWms]$/;
const LARGE = /^(Nm?\/.*|Hz)$/;

/**
 * One prefix for all values that are displayed together, chosen by the largest magnitude: one to three digits before
 * the point, as in the sentences and reports of the daemon. The prefix of a square is squared: 1 mrad² is 10⁻⁶ rad².
 */
export function scaleFor(unit: string, largest: number): Scale {
	const size = Math.abs(largest);
	if (unit.startsWith('rad²')) {
		const { factor, unit: prefixed } = scaleFor('rad', Math.sqrt(size));
		return { factor: factor ** 2, unit: prefixed.replace('rad', unit) };
	}
	if (LARGE.test(unit) && size >= 1e4) return size >= 1e7 ? { factor: 1e-6, unit: `M${unit}` } : { factor: 1e-3, unit: `k${unit}` };
	if (!SMALL.test(unit) || size === 0 || size >= 1) return { factor: 1, unit };
	if (size >= 1e-3) return { factor: 1e3, unit: `m${unit}` };
	return size >= 1e-6 ? { factor: 1e6, unit: `µ${unit}` } : { factor: 1e9, unit: `n${unit}` };
}

/** The prefix for values that are displayed together, in addition to the displayed unit. */
export function withPrefix(shown: Scale, values: readonly (number | null | undefined)[]): Scale {
	const prefix = scaleFor(shown.unit === '1' ? '' : shown.unit, Math.max(0, ...values.map((value) => Math.abs((value ?? 0) * shown.factor))));
	return { factor: shown.factor * prefix.factor, unit: prefix.unit };
}

/** The size that chooses the prefix of a value and its interval, as in the daemon: the largest of these numbers. */
export const prefixSize = (value: number, interval: Interval): number => Math.max(Math.abs(value), ...interval.map((end) => Math.abs(end ?? 0)).filter(Number.isFinite));

export function formatQuantity(value: number | null | undefined, unit: string, digits = 3): string {
	if (value == null || !Number.isFinite(value)) return '–';
	const scale = scaleFor(unit, value);
	return `${formatNumber(value * scale.factor, digits)} ${scale.unit}`.trim();
}

/** A value and its limit with one prefix and equal decimals, so that they compare at a glance: `1.2 / 30.0 A`. */
export function formatAgainstLimit(value: number | null | undefined, limit: number, unit: string): string {
	const scale = scaleFor(unit, limit);
	const decimals = limit === 0 ? 2 : decimalsFor(Math.abs(limit * scale.factor), 3);
	const text = (one: number) => withoutSignOfZero((one * scale.factor).toFixed(decimals));
	return `${value == null ? '' : `${text(value)} / `}${text(limit)} ${scale.unit}`;
}

const withoutSignOfZero = (text: string): string => text.replace('-', Number(text) === 0 ? '' : MINUS);

export function formatPercent(share: number, digits = 0): string {
	const text = (share * 100).toFixed(digits);
	return `${withoutSignOfZero(text)} %`;
}

/** Relative change: `+0.3 %`, `−83 %`; a change that rounds to zero has no sign. */
export function formatChange(share: number): string {
	const text = formatPercent(share, Math.abs(share) < 0.1 ? 1 : 0);
	return share > 0 && Number.parseFloat(text) > 0 ? `+${text}` : text;
}

/** `1 step`, `1,204 steps` */
export function formatCount(n: number, one: string): string {
	return `${n.toLocaleString('en')} ${one}${n === 1 ? '' : 's'}`;
}

/** `p < 10⁻⁹` instead of many zeros. */
export function formatPValue(p: number, atMost = false): string {
	if (p <= 0) return 'p < 10⁻¹⁶';
	if (p < 1e-3) return `p < 10${superscript(Math.ceil(Math.log10(p)))}`;
	return `p ${atMost ? '≤' : '='} ${p.toFixed(p < 0.1 ? 3 : 2)}`;
}

/** Ends of an interval; `null` if the data sets no bound. */
export type Interval = readonly (number | null)[];

/**
 * A value (or an end of its interval) with the number of digits that the interval justifies, in the notation of its
 * larger end.
 */
export function formatEstimate(value: number | null, interval: Interval): string {
	const [low, high] = interval;
	const width = low == null || high == null ? 0 : Math.abs(high - low) / 2;
	if (value === null || !(width > 0) || value === 0) return formatNumber(value, 4);
	const needed = Math.floor(Math.log10(Math.abs(value))) - Math.floor(Math.log10(width)) + 2;
	return formatNumber(value, Math.min(7, Math.max(2, needed)), Math.max(Math.abs(low!), Math.abs(high!)) < 1e-4 ? 1e-4 : 1e-6);
}

/** `[0.097, 0.105]` */
export function formatInterval(interval: Interval): string {
	return `[${interval.map((edge) => (edge === null ? '?' : formatEstimate(edge, interval))).join(', ')}]`;
}
