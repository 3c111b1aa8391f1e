import type { NewRun } from '../api/types';

/** The fields of the unit under test in the start form, in the order of Enter. */
const UNIT_FIELDS = ['serial', 'part', 'revision', 'batch', 'operator'] as const;
export type UnitField = (typeof UNIT_FIELDS)[number];
export type UnitTexts = Record<UnitField, string>;

/** Limit of the daemon for each text. */
export const MAX_LENGTH = 80;

const STORAGE_KEY = 'jointbench.unit';
/** The folded fields. The browser stores them, but no serial number, because every unit has another one. */
export const DETAIL_FIELDS = UNIT_FIELDS.filter((field) => field !== 'serial');

export function loadUnitTexts(storage: Pick<Storage, 'getItem'>): UnitTexts {
	let stored: Record<string, unknown> = {};
	try {
		stored = (JSON.parse(storage.getItem(STORAGE_KEY) ?? '{}') as Record<string, unknown> | null) ?? {};
	} catch {
		// Another version of the dashboard stored something else.
	}
	const text = (field: UnitField) => (typeof stored[field] === 'string' ? stored[field] : '');
	return { serial: '', part: text('part'), revision: text('revision'), batch: text('batch'), operator: text('operator') };
}

export function saveUnitTexts(texts: UnitTexts, storage: Pick<Storage, 'setItem'>): void {
	storage.setItem(STORAGE_KEY, JSON.stringify(Object.fromEntries(DETAIL_FIELDS.map((field) => [field, texts[field]]))));
}

/** The field that Enter moves to. Enter in the last field stays there: a scanner may send it twice, and no run must start. */
export function fieldAfter(field: UnitField): UnitField {
	return UNIT_FIELDS[UNIT_FIELDS.indexOf(field) + 1] ?? field;
}

/** Unit and operator of a new run. Without a serial number the run has no unit; stored values of part and batch are then unused. */
export function unitOf(texts: UnitTexts): Pick<NewRun, 'unit' | 'operator'> {
	const filled = (fields: readonly UnitField[]) => Object.fromEntries(fields.map((field) => [field, texts[field].trim()]).filter(([, text]) => text));
	const serial = texts.serial.trim();
	return { ...(serial ? { unit: { serial, ...filled(['part', 'revision', 'batch']) } } : {}), ...filled(['operator']) };
}

/** The folded fields in a line. */
export function foldedText(texts: UnitTexts): string {
	return DETAIL_FIELDS.flatMap((field) => (texts[field].trim() ? [`${field} ${texts[field].trim()}`] : [])).join(' · ') || 'Part, revision, batch, operator';
}
