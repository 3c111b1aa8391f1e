import { describe, expect, it } from 'vitest';
import { afterGesture, readRange, readHiddenCurves, readOwnRanges, rangeView, writeRange, writeHiddenCurves, writeOwnRanges } from './plotRange';
import { channelGroups } from './channelGroups';
import { shortMeans } from './shortMeans';
import { activeStep } from './progress';

describe('following the live end', () => {
	const follow = readRange(null, true);

	it('goes on after a zoom, with the new width', () => {
		const next = afterGesture(follow, [92, 97], 'zoom');
		expect(next).toEqual({ follow: true, width_s: 5 });
		expect(rangeView(next, 100)).toEqual([95, 100]);
	});

	it('stands still after moving back', () => {
		const next = afterGesture(follow, [80, 90], 'pan');
		expect(next).toEqual({ follow: false, view: [80, 90] });
		expect(afterGesture(follow, null, 'all')).toEqual({ follow: false, view: null });
	});

	it('survives in the address', () => {
		for (const text of ['follow:7.5', '12.5:30', 'all']) expect(writeRange(readRange(text, true))).toBe(text);
		expect(rangeView(readRange('all', true), 40), 'all of a run that is on is what there is by now').toEqual([0, 40]);
		expect(readRange('nonsense', true)).toEqual({ follow: false, view: null });
		expect(readRange(null, false)).toEqual({ follow: false, view: null });
		expect(readRange('follow:7.5', false), 'nothing is followed once the run is over').toEqual({ follow: false, view: null });
	});
});

it('keeps the zooms of single plots in the address', () => {
	const owns = new Map([['rad/s', 'follow:2'], ['', '3:5']]);
	expect(readOwnRanges(writeOwnRanges(owns))).toEqual(owns);
	expect(readOwnRanges(null).size + readOwnRanges('').size).toBe(0);
});

it('draws channels of one unit together', () => {
	const names = ['time_s', 'motor_current_a', 'motor_velocity_rad_s', 'velocity_setpoint_rad_s', 'brake_current_a', 'segment'];
	const groups = channelGroups(names.map((name) => ({ name })));
	expect(groups.map((group) => [group.title, group.names.length])).toEqual([
		['velocity [rad/s]', 2],
		['current [A]', 2],
	]);
	expect(groups[0]!.curves[0]!.dash).not.toEqual(groups[0]!.curves[1]!.dash);
});

it('draws the small angles of a stage apart from the turns of a shaft', () => {
	const groups = channelGroups(['stage_tilt_rad', 'reference_position_rad', 'stage_nod_rad'].map((name) => ({ name })));
	expect(groups.map((group) => [group.title, group.names.length])).toEqual([
		['position [rad]', 1],
		['stage angle [rad]', 2],
	]);
});

it('draws the model of a run that is on beside what was measured, apart from the load', () => {
	const names = ['link_torque_nm', 'motor_torque_nm', 'model_torque_nm'];
	const [torque, load] = channelGroups(names.map((name) => ({ name })), undefined, 'model 12');
	expect([torque!.title, ...torque!.curves.map((curve) => curve.label)]).toEqual(['motor torque [Nm]', 'measured', 'model 12']);
	expect(torque!.curves[1]!.dash).not.toEqual([]);
	expect(load!.names).toEqual(['link_torque_nm']);
});

it('counts the step that is on, and stays on the last', () => {
	const at = (step: number) => activeStep({ step, steps: 3, label: '', elapsed_s: 0, remaining_s: 0, fraction: 0, at_most: false });
	expect([at(0), at(1), at(3)]).toEqual([1, 2, 3]);
});

it('takes what a model leaves together over fifths of a second', () => {
	expect(shortMeans([0, 0.1, 0.25, 0.3, 0.7], [3, 5, 7, NaN, 1], [1, 1, 1, 1, null])).toEqual([[0.1, 3], [expect.closeTo(0.3), 6]]);
});

it('keeps in the address which channels are hidden, by unit', () => {
	const offs = new Map([['Nm', ['link torque', 'limit, link torque']], ['A', []], ['', ['torque valid']]]);
	expect(writeHiddenCurves(offs)).toBe('Nm:link torque:limit, link torque;:torque valid');
	expect([...readHiddenCurves(writeHiddenCurves(offs))]).toEqual([['Nm', ['link torque', 'limit, link torque']], ['', ['torque valid']]]);
	expect(readHiddenCurves(null).size).toBe(0);
});
