/** What a run table holds, by kind of measurement; as the daemon's file format says. */
export interface Kind {
	id: string;
	required: string[];
	optional: string[];
	/** Facts about the set-up that the models of this kind need or use. */
	facts: string[];
	/** Without these nothing is fitted. */
	must?: string[];
	baseline: string[];
}

const ALWAYS = ['temperature_c', 'segment', 'repeat'];

export const KINDS: Kind[] = [
	{
		id: 'friction',
		required: ['time_s', 'motor_position_rad', 'motor_current_a'],
		optional: ['motor_velocity_rad_s', 'link_position_rad', 'link_torque_nm', 'brake_current_a', 'brake_torque_command_nm', ...ALWAYS],
		facts: ['torque_constant_nm_per_a', 'gear_ratio', 'rotor_inertia_kg_m2'],
		must: ['torque_constant_nm_per_a'],
		baseline: ['inertia', 'load_transmission', 'coulomb', 'viscous'],
	},
	{
		id: 'encoder',
		required: ['time_s', 'reference_position_rad', 'test_position_rad'],
		optional: ['velocity_rad_s', ...ALWAYS],
		facts: ['reference_bits', 'test_bits', 'pole_pairs'],
		baseline: ['offset'],
	},
	{
		id: 'stiffness',
		required: ['time_s', 'motor_position_rad', 'link_position_rad', 'link_torque_nm'],
		optional: ['link_velocity_rad_s', ...ALWAYS],
		facts: ['gear_ratio'],
		must: ['gear_ratio'],
		baseline: ['offset', 'compliance'],
	},
	{
		id: 'brake',
		required: ['time_s', 'brake_current_a', 'brake_torque_nm'],
		optional: ['velocity_rad_s', 'position_rad', ...ALWAYS],
		facts: ['rated_current_a', 'poles'],
		baseline: ['drag', 'torque_per_current'],
	},
];

export interface Unit {
	name: string;
	/** SI value of one of it. */
	factor: number;
}

const UNITS: [suffix: string, units: [string, number][]][] = [
	['_rad_s', [['rad/s', 1], ['rpm', (2 * Math.PI) / 60], ['deg/s', Math.PI / 180]]],
	['_rad', [['rad', 1], ['deg', Math.PI / 180], ['turn', 2 * Math.PI], ['mrad', 1e-3]]],
	['_nm', [['Nm', 1], ['mNm', 1e-3], ['Ncm', 1e-2]]],
	['_a', [['A', 1], ['mA', 1e-3]]],
	['_s', [['s', 1], ['ms', 1e-3], ['µs', 1e-6]]],
	['_c', [['°C', 1]]],
];

/** Units that a column may come in; the first is the daemon's own. */
export function unitsOf(column: string): Unit[] {
	const found = UNITS.find(([suffix]) => column.endsWith(suffix));
	return (found?.[1] ?? [['', 1]]).map(([name, factor]) => ({ name, factor }));
}
