/** Column names for display. The unit is the suffix of the name. */

const SUFFIXES: [string, string][] = [
	['_nm_per_rad', 'Nm/rad'],
	['_nm_rad', 'Nm/rad'],
	['_nm_s', 'Nm·s/rad'],
	['_nm_per_a', 'Nm/A'],
	['_kg_m2', 'kg·m²'],
	['_rad_s2', 'rad/s²'],
	['_rad_s', 'rad/s'],
	['_rad', 'rad'],
	['_nm', 'Nm'],
	['_hz', 'Hz'],
	['_percent', '%'],
	['_pa', 'Pa'],
	['_ms', 'ms'],
	['_w', 'W'],
	['_v', 'V'],
	['_a', 'A'],
	['_c', '°C'],
	['_s', 's'],
	['_m', 'm'],
];

const TITLES: Record<string, string> = {
	link_torque_nm: 'load (link torque)',
	way_since_reversal_rad: 'travel since reversal',
	run_order: 'order in the run',
	direction: 'direction of motion',
};

export interface Label {
	title: string;
	unit: string;
}

export function label(column: string, unit?: string | null): Label {
	const suffix = SUFFIXES.find(([end]) => column.endsWith(end));
	const withoutUnit = suffix ? column.slice(0, -suffix[0].length) : column;
	return { title: TITLES[column] ?? withoutUnit.replaceAll('_', ' ').replace('setpoint', 'set point'), unit: unit ?? suffix?.[1] ?? '' };
}

/** The unit on a sliding axis. */
export const linearUnit = (unit: string): string => unit.replace('kg·m²', 'kg').replace('Nm', 'N').replace('rad', 'm');

/** `motor velocity [rad/s]` */
export function axisTitle(column: string, unit?: string | null): string {
	const { title, unit: known } = label(column, unit);
	return known && known !== '1' ? `${title} [${known}]` : title;
}

const ID_TEXTS: Record<string, string> = {
	joint: 'joint drive',
	torque_sensor: 'torque sensor',
	brake: 'brake current source',
};

/** Ids as words: `viscous_asymmetry` → `viscous asymmetry`. */
export function idText(id: string): string {
	return ID_TEXTS[id] ?? id.replaceAll('_', ' ');
}

type Titles = readonly { id: string; title: string }[];

/** The title of an effect, or its id as words. */
export const effectTitle = (effects: Titles | undefined, id: string): string => effects?.find((one) => one.id === id)?.title ?? idText(id);

/** A suffix that can only be a unit; `tau_c` is not a temperature. */
const UNIT_SUFFIX = /_(nm_rad|rad_s2?|rad|nm|hz)$|(?<=current)_a$|(?<=temperature)_c$|(?<=time)_s$/;
/** A minus sign before a number that is not after another number. */
const SIGN = /(?<![\w.,)\]])-(?=\d)/g;

/** Replaces hyphens by minus signs in a text of the daemon. */
export const withMinusSigns = (text: string): string => text.replace(SIGN, '−');

/** A title inside a sentence; names of persons keep their capital. */
export const inSentence = (title: string): string => title.replace(/^(?!Coul|Strib)./, (first) => first.toLowerCase());

/**
 * A sentence of the daemon for display: effects by their titles, other ids as words without their unit, with a capital
 * at its start. The keys of a bench file stay as they are written: `gear_ratio in [bench.constants]`.
 */
export function displayText(sentence: string, effects: Titles = []): string {
	const replaced = sentence.replace(/(?<![\w.])[a-z]+(_[a-z0-9]+)+(?![\w.]*(?:[=(]| in \[))/g, (id) => {
		const title = effects.find((one) => one.id === id)?.title;
		return title === undefined ? idText(id.replace(UNIT_SUFFIX, '')) : inSentence(title);
	});
	return replaced.charAt(0).toUpperCase() + withMinusSigns(replaced.slice(1));
}

/** Settings in a sentence of the daemon by their labels in the form. A name without underscore is a common word. */
export const withLabels = (sentence: string, fields: readonly { name: string; title: string }[] = []): string =>
	fields.filter(({ name }) => name.includes('_')).reduce((text, { name, title }) => text.replaceAll(new RegExp(`(?<![\\w.])${name}(?!\\w)`, 'g'), `“${title}”`), sentence);

/** The end of a path, which says more than its beginning. Names stay complete. */
export const pathEnd = (name: string): string => (/[\\/]/.test(name) ? `…/${name.split(/[\\/]/).filter(Boolean).slice(-2).join('/')}` : name);

/** Average width of a letter of the small print [px]. */
export const LETTER_PX = 6.1;

/** Cuts a text to the available width, for drawings that cannot wrap. The full text belongs in a title. */
export function truncate(text: string, width_px: number): string {
	const letters = Math.max(2, Math.floor(width_px / LETTER_PX));
	return text.length <= letters ? text : `${text.slice(0, letters - 1).trimEnd()}…`;
}

/** The same in two lines, broken between words. */
export function inTwoLines(text: string, width_px: number): string[] {
	const end = text.lastIndexOf(' ', width_px / LETTER_PX);
	const short = truncate(text, width_px);
	return short === text || end < 3 ? [short] : [text.slice(0, end), truncate(text.slice(end + 1), width_px)];
}
