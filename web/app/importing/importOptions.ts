import type { Choices } from '../api/upload';
import type { ImportPreview } from '../api/types';
import type { Mapping } from './columns';

/** Parts of a request with a single value. */
const SINGLE = new Set(['rate', 'time_from_rate', 'names', 'spread_time', 'operating_points', 'split_runs', 'leave_empty_rows']);

/**
 * Converts a proposed option of the command line, such as `--unit time_s=ms --map 'time_s=Time [ms]'`, to parts of a
 * request.
 */
export function parseOption(text: string): [part: string, value: string][] {
	const words = text.match(/'(?:[^']|'\\'')*'|[^\s']+/g) ?? [];
	const bare = words.map((word) => (word.startsWith("'") ? word.slice(1, -1).replaceAll("'\\''", "'") : word));
	return bare.flatMap((word, i) => {
		if (!word.startsWith('--')) return [];
		const value = bare[i + 1];
		return [[word.slice(2).replaceAll('-', '_'), value === undefined || value.startsWith('--') ? 'true' : value] as [string, string]];
	});
}

/** Adds an option. It replaces an option for the same part and column. */
export function withOption(choices: Choices, text: string): Choices {
	const next = { ...choices };
	for (const [part, value] of parseOption(text)) {
		const of = (one: string) => one.slice(0, one.lastIndexOf('='));
		const others = (next[part] ?? []).filter((one) => !SINGLE.has(part) && one !== value && (!value.includes('=') || of(one) !== of(value)));
		next[part] = [...others, value];
	}
	return next;
}

/** Removes one value of a part. */
export function without(choices: Choices, part: string, value: string): Choices {
	const rest = (choices[part] ?? []).filter((one) => one !== value);
	const { [part]: _gone, ...others } = choices;
	return rest.length ? { ...others, [part]: rest } : others;
}

/** Whether a proposal can be applied unchanged: `--rate HZ` lacks its number, and names are chosen in the table. */
export const isWhole = (option: string) => parseOption(option).every(([part, value]) => (part !== 'rate' || Number.isFinite(+value)) && part !== 'names' && !value.includes('counts/N'));

/** The source of the time of a table. */
export type Timing = 'column' | 'rate' | 'spread_time' | 'operating_points';
const TIMINGS = ['rate', 'time_from_rate', 'spread_time', 'operating_points'];

export function timingOf(choices: Choices): Timing {
	const part = TIMINGS.find((one) => choices[one]);
	return part === 'time_from_rate' ? 'rate' : ((part as Timing | undefined) ?? 'column');
}

/** Selects another source of the time. `rate`: rows per second, which replace the time of the file if it `hasTime`. */
export function withTiming(choices: Choices, timing: Timing, rate: string, hasTime: boolean): Choices {
	const others = Object.fromEntries(Object.entries(choices).filter(([part]) => !TIMINGS.includes(part)));
	if (timing === 'column' || (timing === 'rate' && !rate.trim())) return others;
	return { ...others, ...(timing === 'rate' ? { [hasTime ? 'time_from_rate' : 'rate']: [rate] } : { [timing]: ['true'] }) };
}

/** A choice in words, for buttons and for the list of choices. */
export function inWords(part: string, value: string): string {
	const [column, what = ''] = value.includes('=') ? [value.slice(0, value.lastIndexOf('=')), value.slice(value.lastIndexOf('=') + 1)] : [value];
	switch (part) {
		case 'map':
			return `${column} is ${what}`;
		case 'unit':
			return `${column} in ${what}`;
		case 'scale':
			return `${column} × ${what.replace('-', '−')}`;
		case 'unwrap':
			return `make ${column} continuous`;
		case 'leave':
			return `omit ${value}`;
		case 'decimal':
			return what ? `${column}: decimal ${what}` : `decimal ${value}`;
		case 'missing':
			return value === 'none' ? 'no number stands for an empty cell' : `${value} is an empty cell`;
		case 'rate':
		case 'time_from_rate':
			return `${value} rows a second`;
		case 'spread_time':
			return 'spread repeated time stamps';
		case 'operating_points':
			return 'each row is one operating point';
		case 'split_runs':
			return 'several recordings';
		case 'leave_empty_rows':
			return 'omit rows with empty cells';
		default:
			return `${part.replaceAll('_', ' ')} ${value}`;
	}
}

/** A proposed option in words. */
export const optionInWords = (option: string) =>
	parseOption(option)
		.map(([part, value]) => inWords(part, value))
		.join(', ');

/** Choices for a file that are offered again for the next file with the same columns. */
export interface Remembered {
	kind: string;
	mapping: Mapping;
	facts: Record<string, string>;
	left: string[];
	choices: Choices;
}

const KEY = 'jointbench.imports';
/** Number of stored column sets; the oldest are deleted first. */
const MOST = 30;

/** Files with the same column names have the same shape. */
const shapeOf = (preview: ImportPreview) => preview.columns.map(({ name }) => name).join('\n');

function kept(storage: Storage): [shape: string, what: Remembered][] {
	try {
		const found: unknown = JSON.parse(storage.getItem(KEY) ?? '[]');
		return Array.isArray(found) ? (found as [string, Remembered][]) : [];
	} catch {
		return [];
	}
}

export const recall = (preview: ImportPreview, storage: Storage): Remembered | null => kept(storage).find(([shape]) => shape === shapeOf(preview))?.[1] ?? null;

export function remember(preview: ImportPreview, what: Remembered, storage: Storage): void {
	const shape = shapeOf(preview);
	const others = kept(storage).filter(([one]) => one !== shape);
	storage.setItem(KEY, JSON.stringify([...others, [shape, what]].slice(-MOST)));
}
