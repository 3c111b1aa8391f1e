/** Content of a run table by kind of measurement, as in the daemon's file format. */
export interface Kind {
	id: string;
	required: string[];
	optional: string[];
	/** Facts about the set-up that the models of this kind need or use. */
	facts: string[];
	/** A fit is impossible without these facts. */
	mandatoryFacts?: string[];
	baseline: string[];
}

const COMMON = ['temperature_c', 'segment', 'repeat'];

export const KINDS: Kind[] = [
	{
		id: 'friction',
		required: ['time_s', 'motor_position_rad', 'motor_current_a'],
		optional: ['motor_velocity_rad_s', 'link_position_rad', 'link_torque_nm', 'brake_current_a', 'brake_torque_command_nm', ...COMMON],
		facts: ['torque_constant_nm_per_a', 'gear_ratio', 'rotor_inertia_kg_m2'],
		mandatoryFacts: ['torque_constant_nm_per_a'],
		baseline: ['inertia', 'load_transmission', 'coulomb', 'viscous'],
	},
	{
		id: 'encoder',
		required: ['time_s', 'reference_position_rad', 'test_position_rad'],
		optional: ['velocity_rad_s', ...COMMON],
		facts: ['reference_bits', 'test_bits', 'pole_pairs'],
		baseline: ['offset'],
	},
	{
		id: 'stiffness',
		required: ['time_s', 'motor_position_rad', 'link_position_rad', 'link_torque_nm'],
		optional: ['link_velocity_rad_s', ...COMMON],
		facts: ['gear_ratio'],
		mandatoryFacts: ['gear_ratio'],
		baseline: ['offset', 'compliance'],
	},
	{
		id: 'brake',
		required: ['time_s', 'brake_current_a', 'brake_torque_nm'],
		optional: ['velocity_rad_s', 'position_rad', ...COMMON],
		facts: ['rated_current_a', 'poles'],
		baseline: ['drag', 'torque_per_current'],
	},
];

/** The source of a column of the daemon. */
export interface Source {
	/** Name in the file; empty: missing. */
	from: string;
	/** Name of the unit in the file; empty: the unit that the file states, or that the daemon asks for. */
	unit: string;
}

export type Mapping = Record<string, Source>;

/** Units to choose from; the first one is the daemon's own. The daemon supports more units (docs/your-files.md). */
const UNITS: [suffix: string, units: string[]][] = [
	['_rad_s', ['rad/s', 'rpm', 'deg/s', 'rev/s']],
	['_rad', ['rad', 'deg', 'rev', 'mrad', 'arcmin', 'counts/4096', 'counts/8192', 'counts/16384', 'counts/65536']],
	['_nm', ['Nm', 'mNm', 'Ncm', 'ozf·in', 'lbf·in', 'lbf·ft', 'kgf·cm']],
	['_a', ['A', 'mA']],
	['_s', ['s', 'ms', 'µs', 'ns', 'days']],
	['_c', ['°C', 'K', '°F']],
];

/** Possible units of a column, including `stated`; none for a whole number. */
export function unitsOf(column: string, stated = ''): string[] {
	const found = UNITS.find(([suffix]) => column.endsWith(suffix))?.[1] ?? [];
	return stated && !found.includes(stated) ? [...found, stated] : found;
}

/** The mapping as options for the daemon. */
export function mappingOptions(mapping: Mapping): { map: string[]; unit: string[] } {
	const used = Object.entries(mapping).filter(([, source]) => source.from !== '');
	return {
		map: used.filter(([column, { from }]) => from !== column).map(([column, { from }]) => `${column}=${from}`),
		unit: used.filter(([column, { from, unit }]) => unit !== '' && (from !== column || unit !== unitsOf(column)[0])).map(([column, { unit }]) => `${column}=${unit}`),
	};
}
