import type { ImportOptions } from '../api/upload';
import type { ImportOption, ImportPreview } from '../api/types';
import type { Mapping } from './columns';

/** Parts of a request with a single value. */
const SINGLE = new Set(['rate', 'time_from_rate', 'names', 'spread_time', 'operating_points', 'split_runs', 'leave_empty_rows']);

/** Adds options. Each replaces an option for the same part and column. */
export function withOptions(options: ImportOptions, added: readonly ImportOption[]): ImportOptions {
	const next = { ...options };
	for (const { name: part, value } of added) {
		const of = (one: string) => one.slice(0, one.lastIndexOf('='));
		const others = (next[part] ?? []).filter((one) => !SINGLE.has(part) && one !== value && (!value.includes('=') || of(one) !== of(value)));
		next[part] = [...others, value];
	}
	return next;
}

/** Removes one value of a part. */
export function withoutOption(options: ImportOptions, part: string, value: string): ImportOptions {
	const rest = (options[part] ?? []).filter((one) => one !== value);
	const { [part]: _gone, ...others } = options;
	return rest.length ? { ...others, [part]: rest } : others;
}

/** The source of the time of a table. */
export type TimeSource = 'column' | 'rate' | 'spread_time' | 'operating_points';
const TIME_SOURCES = ['rate', 'time_from_rate', 'spread_time', 'operating_points'];

export function timeSourceOf(options: ImportOptions): TimeSource {
	const part = TIME_SOURCES.find((one) => options[one]);
	return part === 'time_from_rate' ? 'rate' : ((part as TimeSource | undefined) ?? 'column');
}

/** Selects another source of the time. `rate`: rows per second, which replace the time of the file if it `hasTime`. */
export function withTimeSource(options: ImportOptions, source: TimeSource, rate: string, hasTime: boolean): ImportOptions {
	const others = Object.fromEntries(Object.entries(options).filter(([part]) => !TIME_SOURCES.includes(part)));
	if (source === 'column' || (source === 'rate' && !rate.trim())) return others;
	return { ...others, ...(source === 'rate' ? { [hasTime ? 'time_from_rate' : 'rate']: [rate] } : { [source]: ['true'] }) };
}

/** A choice in words, for buttons and for the list of choices. */
export function optionValueText(part: string, value: string): string {
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
		case 'omit_rows':
			return `omit lines ${value.replaceAll('-', '–').replaceAll(',', ', ')}`;
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

/** Proposed options in words. */
export const optionsText = (options: readonly ImportOption[]) => options.map(({ name, value }) => optionValueText(name, value)).join(', ');

/** Choices for a file that are offered again for the next file with the same columns. */
export interface SavedMapping {
	kind: string;
	mapping: Mapping;
	facts: Record<string, string>;
	left: string[];
	choices: ImportOptions;
}

const KEY = 'jointbench.imports';
/** Number of stored column sets; the oldest are deleted first. */
const MAX_SAVED = 30;

/** Files with the same column names have the same shape. */
const shapeOf = (preview: ImportPreview) => preview.columns.map(({ name }) => name).join('\n');

function savedMappings(storage: Storage): [shape: string, what: SavedMapping][] {
	try {
		const found: unknown = JSON.parse(storage.getItem(KEY) ?? '[]');
		return Array.isArray(found) ? (found as [string, SavedMapping][]) : [];
	} catch {
		return [];
	}
}

export const loadMapping = (preview: ImportPreview, storage: Storage): SavedMapping | null => savedMappings(storage).find(([shape]) => shape === shapeOf(preview))?.[1] ?? null;

export function saveMapping(preview: ImportPreview, what: SavedMapping, storage: Storage): void {
	const shape = shapeOf(preview);
	const others = savedMappings(storage).filter(([one]) => one !== shape);
	storage.setItem(KEY, JSON.stringify([...others, [shape, what]].slice(-MAX_SAVED)));
}
