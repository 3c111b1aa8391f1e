import { expect, it } from 'vitest';
import { withLabels, axisTitle, truncate, inSentence, inTwoLines, label, linearUnit, displayText, pathEnd } from './label';

it('reads the unit from the suffix', () => {
	expect(label('motor_velocity_rad_s')).toEqual({ title: 'motor velocity', unit: 'rad/s' });
	expect(label('torque_constant_nm_per_a').unit).toBe('Nm/A');
	expect(label('bearing_stiffness_nm_rad')).toEqual({ title: 'bearing stiffness', unit: 'Nm/rad' });
	expect(label('stage_radial_m')).toEqual({ title: 'stage radial', unit: 'm' });
	expect(label('time_s')).toEqual({ title: 'time', unit: 's' });
	expect(label('segment')).toEqual({ title: 'segment', unit: '' });
});

it('trusts a unit that is given', () => {
	expect(axisTitle('motor_position_rad', 'm')).toBe('motor position [m]');
	expect(axisTitle('direction', '1')).toBe('direction of motion');
});

it('says ids of a sentence as words', () => {
	expect(displayText('it would show load_linear and stribeck_load, at 5 mNm')).toBe('It would show load linear and stribeck load, at 5 mNm');
	expect(displayText('Missing effects: load_linear, then load_viscous.', [{ id: 'load_linear', title: 'Load-dependent friction' }])).toBe('Missing effects: load-dependent friction, then load viscous.');
	expect(['Viscous friction', 'Stribeck effect'].map(inSentence)).toEqual(['viscous friction', 'Stribeck effect']);
	expect(displayText('motor_current_a is -1.5 times what 0-3 gives, by time_s')).toBe('Motor current is −1.5 times what 0-3 gives, by time');
	expect(displayText('bench a has no gear: state load_gear_ratio in [bench.constants]')).toBe('Bench a has no gear: state load_gear_ratio in [bench.constants]');
	expect(displayText('repeat with a lower stribeck_speed_rad_s, for tau_c')).toBe('Repeat with a lower stribeck speed, for tau c');
});

it('cuts what has no room', () => {
	expect(truncate('friction ripple', 200)).toBe('friction ripple');
	expect(truncate('friction ripple', 62)).toBe('friction…');
});

it('reads units as an axis that slides has them', () => {
	expect(['rad/s', 'Nm', 'Nm/A', 'kg·m²', 'Nm·s/rad', 's'].map(linearUnit)).toEqual(['m/s', 'N', 'N/A', 'kg', 'N·s/m', 's']);
});

it('keeps the end of a path', () => {
	expect(['/data/emps/run.csv', 'C:\\data\\run.csv', 'joint-a'].map(pathEnd)).toEqual(['…/emps/run.csv', '…/data/run.csv', 'joint-a']);
});

it('breaks a label that has no room between its words', () => {
	expect(inTwoLines('+ Coulomb', 100)).toEqual(['+ Coulomb']);
	expect(inTwoLines('+ Load-dependent friction', 100)).toEqual(['+ Load-dependent', 'friction']);
	expect(inTwoLines('+ Transmissionlosses', 60)).toEqual(['+ Transm…']);
});

it('names settings as in the form', () => {
	const fields = [{ name: 'top_speed_rad_s', title: 'Maximum speed (motor)' }, { name: 'repeats', title: 'Repeats of the profile' }];
	expect(withLabels('set top_speed_rad_s = 120 or less, or add repeats', fields)).toBe('set “Maximum speed (motor)” = 120 or less, or add repeats');
	expect(withLabels('stop_top_speed_rad_s', fields)).toBe('stop_top_speed_rad_s');
});
