import { expect, it } from 'vitest';
import type { Samples } from '../api/types';
import { alignCurves, chosenChannels, channelCurve, factTable, meanRow, matchingEvent, sharedEvents } from './align';
import { searchCompletions } from './searchCompletions';
import { changeFrom, differenceText, estimatesDiffer } from './differences';
import { readComparedRuns, toggleComparedRun, withBase } from './comparedRuns';

const samples = {
	time_s: [0, 1, 2, 3],
	channels: [
		{ name: 'torque', min: [1, 2, 3, 4], max: [1, 2, 9, 4] },
		{ name: 'speed', min: [4, 3, 2, null], max: [4, 3, 2, null] },
	],
} as unknown as Samples;

it('puts runs on one axis and keeps a spike', () => {
	const course = channelCurve(samples, 'torque');
	const { x, columns } = alignCurves([course, null]);
	expect(x).toEqual([0.75, 0.75, 2.25, 2.25]);
	expect(columns[0]).toEqual([1, 2, 3, 9]);
	expect(columns[1]).toEqual([null, null, null, null]);
});

it('leaves out a channel that a run does not have', () => {
	expect(channelCurve(samples, 'absent')).toBeNull();
	expect(alignCurves([null])).toEqual({ x: [], columns: [[]] });
});

it('aligns by a moment that all runs have', () => {
	const at = (at_s: number, text: string, kind = 'step_started') => ({ key: `${kind}/${text}`, text, at_s, kind });
	const first = [at(0, 'running', 'state'), at(4, 'step'), at(8, 'step 1 done, 9 rows', 'step_finished'), at(9, 'step'), at(5, 'limit')];
	const second = [at(0, 'running', 'state'), at(2.5, 'step'), at(7, 'step 1 done, 9 rows', 'step_finished')];
	expect(sharedEvents([first, second])).toEqual([{ key: 'step_started/step', text: 'step', kind: 'step_started', times_s: [4, 2.5] }]);
	expect(channelCurve(samples, 'torque', 2)!.x).toEqual([-2, -1, 0, 1]);
});

it('finds the event that was meant', () => {
	const moments = ['step 12: hold', 'step 1', 'Limit torque'].map((text) => ({ text }));
	expect(['step 1', 'hold', 'limit', ' ', 'oil'].map((typed) => matchingEvent(typed, moments)).map((found) => found && found.text)).toEqual(['step 1', 'step 12: hold', 'Limit torque', null, undefined]);
});

it('tells figures that differ from those that only look different', () => {
	const given = (value: number, half: number) => ({ value, ci95: [value - half, value + half] });
	expect(estimatesDiffer([given(1, 0.3), given(1.4, 0.3)])).toBe(false);
	expect(estimatesDiffer([given(1, 0.3), given(1.5, 0.3)])).toBe(true);
	expect(estimatesDiffer([given(1, 0.3), null, { value: 9, ci95: [null, 10] }, { value: 9 }])).toBeNull();
	expect(differenceText(given(1, 0.3), given(0.9, 0.4), { factor: 1000, unit: 'mm' })).toBe('−100 ± 500 mm');
	expect(differenceText(given(1, 0.3), { value: 2 }, { factor: 1, unit: '' })).toBe('');
});

it('shows where settings differ', () => {
	const table = factTable([
		{ kind: 'friction', oil: { name: 'A', age_h: 1 } },
		{ kind: 'friction', oil: { name: 'B' }, parts: [{ procedure: 'warm_up', first_segment: 0 }, { procedure: 'strokes' }] },
	]);
	expect(table).toEqual([
		{ name: 'kind', values: ['friction', 'friction'], differs: false },
		{ name: 'oil.name', values: ['A', 'B'], differs: true },
		{ name: 'oil.age_h', values: ['1', '–'], differs: true },
		{ name: 'parts', values: ['–', 'warm_up, strokes'], differs: true },
	]);
});

it('tells means apart where the runs do not scatter as far', () => {
	const cold = { mean: 22, deviation: 0.2 };
	expect(meanRow('temperature', [cold, { mean: 31.04, deviation: 0.4 }, undefined], 1)).toEqual({ name: 'temperature', values: ['22.0', '31.0', '–'], differs: true });
	expect(meanRow('temperature', [cold, { mean: 22.8, deviation: 0.1 }], 1).differs).toBe(false);
	expect(meanRow('temperature', [cold, { mean: 26, deviation: 3 }], 1).differs).toBe(false);
	expect(meanRow('temperature', [cold, { mean: null, deviation: null }], 1).differs).toBe(false);
});

it('compares at most six runs', () => {
	expect(readComparedRuns('3,1,x,3')).toEqual([3, 1]);
	expect(toggleComparedRun([3, 1], 1)).toEqual([3]);
	expect(toggleComparedRun([1, 2, 3, 4, 5, 6], 7)).toEqual([1, 2, 3, 4, 5, 6]);
});

it('completes the last term of a search', () => {
	const values = { tag: ['oil', 'warm oil'], state: ['failed', 'completed'] };
	expect(searchCompletions('joint ta', values)).toEqual(['joint tag:']);
	expect(searchCompletions('-state:f', values)).toEqual(['-state:failed']);
	expect(searchCompletions('tag:', values)).toEqual(['tag:oil', 'tag:"warm oil"']);
	expect(searchCompletions('tag:oil', values)).toEqual([]);
});

it('holds the others against the base, which comes first', () => {
	expect(withBase([3, 1, 2], 2)).toEqual([2, 3, 1]);
	expect(changeFrom({ value: -2 }, { value: -1.5 })).toBe('+25 %');
	expect(changeFrom({ value: 4 }, { value: 3.9 })).toBe('−2.5 %');
	expect(changeFrom({ value: 0.1, ci95: [-0.1, 0.3] }, { value: 0.4 }, 1000)).toBe('+300');
	expect([changeFrom(null, { value: 1 }), changeFrom({ value: 0 }, { value: 1 })]).toEqual(['', '']);
});

it('compares the channels that the address names, or a torque', () => {
	const drawable = ['motor_velocity_rad_s', 'motor_current_a', 'link_torque_nm'].map((name) => ({ name }));
	expect(chosenChannels('link_torque_nm,gone,motor_velocity_rad_s', drawable).map(({ name }) => name)).toEqual(['link_torque_nm', 'motor_velocity_rad_s']);
	expect(chosenChannels('gone', drawable).map(({ name }) => name)).toEqual(['motor_current_a']);
	expect(chosenChannels(null, [])).toEqual([]);
});
