import { type Kind, KINDS, type Unit, unitsOf } from './columns';

/** Where a column of the daemon comes from. */
export interface Source {
	/** Name in the file; empty: not there. */
	from: string;
	/** Name of the unit there. */
	unit: string;
}

export type Mapping = Record<string, Source>;

/** Names that people give these columns, without unit, case and signs. */
const ALIASES: Record<string, RegExp> = {
	time_s: /^(t|time|zeit|timestamp|secs?)$/,
	motor_position_rad: /^(motor(pos|position|angle)|theta_?m|pos(ition)?|angle|q|phi)$/,
	motor_velocity_rad_s: /^(motor(vel|velocity|speed)|omega(m)?|vel(ocity)?|speed|qd|rpm|w)$/,
	motor_current_a: /^(motorcurrent|iq|current|i|strom)$/,
	link_position_rad: /^(link(pos|position|angle)|output(pos|position|angle)|loadangle)$/,
	link_velocity_rad_s: /^(link(vel|velocity|speed)|output(vel|velocity|speed))$/,
	link_torque_nm: /^(link|load|output|sensor)?(torque|tau|moment|drehmoment)$|^(load|last)$/,
	temperature_c: /^(temp(erature)?|winding(temp(erature)?)?|tmotor)$/,
	brake_current_a: /^(brakecurrent|current|ibrake|i)$/,
	brake_torque_nm: /^(brake)?(torque|tau)$/,
	velocity_rad_s: /^(vel(ocity)?|speed|omega|rpm|w)$/,
	position_rad: /^(pos(ition)?|angle|phi)$/,
	reference_position_rad: /^(ref(erence)?(pos(ition)?|angle)?)$/,
	segment: /^(seg(ment)?|step|leg)$/,
	repeat: /^(rep(eat)?|cycle|pass)$/,
	test_position_rad: /^(test|dut|encoder)(pos(ition)?|angle)?$/,
};

const UNIT_WORDS: [RegExp, string][] = [
	[/(rpm|min-1|1\/min)/i, 'rpm'],
	[/(deg|°)\s*(\/|_per_|_)\s*s/i, 'deg/s'],
	[/(deg|°(?!c))/i, 'deg'],
	[/\b(turns?|revs?)\b|_(turns?|revs?)$/i, 'turn'],
	[/mrad/i, 'mrad'],
	[/mnm/i, 'mNm'],
	[/ncm/i, 'Ncm'],
	[/(^|[\s_[(])ma\b/i, 'mA'],
	[/(^|[\s_[(])ms\b/i, 'ms'],
	[/(^|[\s_[(])(us|µs)\b/i, 'µs'],
];

/** A temperature, whatever it is called: `T` is no time there. */
const WARM = /(deg|°)c\b/i;

const TAIL = /[[(].*[\])]|[_\s](rad_s|rad|deg_s|degs?|nm|mnm|ncm|ma|a|ms|us|s|rpm|turns?|revs?|c|v)$/gi;
const bare = (header: string) => header.replace(TAIL, '').toLowerCase().replace(/[^a-z0-9]/g, '');

/** The unit that a header names, where the column may come in it; else the daemon's own. */
export function unitIn(header: string, units: Unit[]): string {
	const word = UNIT_WORDS.find(([pattern, name]) => pattern.test(header) && units.some((unit) => unit.name === name));
	return word?.[1] ?? units[0]!.name;
}

/** The most likely source of each column; exact names first, and no source twice. */
export function guess({ required, optional }: Kind, headers: readonly string[]): Mapping {
	const taken = new Set(headers.filter((header) => [...required, ...optional].includes(header)));
	return Object.fromEntries(
		[...required, ...optional].map((column) => {
			const units = unitsOf(column);
			if (headers.includes(column)) return [column, { from: column, unit: units[0]!.name }];
			const from = headers.find((header) => !taken.has(header) && (WARM.test(header) ? column === 'temperature_c' : ALIASES[column]?.test(bare(header)))) ?? '';
			if (from) taken.add(from);
			return [column, { from, unit: unitIn(from, units) }];
		}),
	);
}

/** The kind that these columns fit best. */
export function guessKind(headers: readonly string[]): Kind {
	const found = (kind: Kind) => kind.required.filter((column) => guess(kind, headers)[column]!.from !== '').length / kind.required.length;
	return KINDS.reduce((best, kind) => (found(kind) > found(best) ? kind : best));
}

/** What the daemon is told: `map` names other columns, `scale` gives factors to SI. */
export function instructions(mapping: Mapping): { map: string[]; scale: string[] } {
	const used = Object.entries(mapping).filter(([, source]) => source.from !== '');
	return {
		map: used.filter(([column, { from }]) => from !== column).map(([column, { from }]) => `${column}=${from}`),
		scale: used.flatMap(([column, { unit }]) => {
			const factor = unitsOf(column).find((one) => one.name === unit)?.factor ?? 1;
			return factor === 1 ? [] : [`${column}=${factor}`];
		}),
	};
}
