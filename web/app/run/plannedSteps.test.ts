import { expect, it } from 'vitest';
import type { Preview } from '../api/types';
import { aroundStep, limitLines, setPointCurve, setPointLines, executedSteps } from './plannedSteps';

const ONE = { factor: 1, unit: 'rad/s' };
const event = (step: number, at_s: number, label: string) => ({ kind: 'step_started', at_s, data: { step, label } });
const plan = {
	steps: [{ label: 'a', duration_s: 2 }, { label: 'b', duration_s: 1 }],
	setpoints: { time_s: [0, 1, 2, 2, 3], motor_velocity_rad_s: [0, 5, 5, -4, 0], brake_current_a: [0, 0, 0, 0, 0] },
} as unknown as Preview;

it('takes the steps of a run from its journal', () => {
	const made = executedSteps([event(0, 0.5, 'at -2 rad/s'), { kind: 'fault', at_s: 1, data: {} }, event(1, 3, 'b')], 9);
	expect(made).toEqual([{ step: 0, label: 'at −2 rad/s', at_s: 0.5, to_s: 3 }, { step: 1, label: 'b', at_s: 3, to_s: 9 }]);
	expect(aroundStep(made[0]!)).toEqual([0.375, 3.125]);
});

it('lays the plan onto the clock of the run, step by step', () => {
	// The first step started with a delay and took 0.5 s longer; the second one is as planned.
	const made = executedSteps([event(0, 0.5, 'a'), event(1, 3, 'b')], 4);
	const { x, y } = setPointCurve(plan, plan.setpoints.time_s, plan.setpoints.motor_velocity_rad_s, made);
	expect(x).toEqual([0.5, 1.5, 2.5, 3, 4]);
	expect(y).toEqual([0, 5, 5, -4, 0]);
});

it('ends a step that was cut where the next one began', () => {
	const made = executedSteps([event(0, 0, 'a'), event(1, 1.2, 'b')], 2.2);
	const { x } = setPointCurve(plan, plan.setpoints.time_s, plan.setpoints.motor_velocity_rad_s, made);
	expect(x.map((at) => at.toFixed(9))).toEqual([0, 1, 1.2, 1.2, 2.2].map((at) => at.toFixed(9)));
});

it('gives set points only to the channels that follow them', () => {
	const made = executedSteps([event(0, 0, 'a')], 2);
	expect(setPointLines(plan, made, ['link_torque_nm'], ONE)).toEqual([]);
	expect(setPointLines(plan, made, ['brake_current_a'], ONE)).toEqual([]);
	expect(setPointLines(plan, made, ['motor_velocity_rad_s', 'velocity_setpoint_rad_s'], ONE), 'what was commanded is a channel of the run').toEqual([]);
	expect(setPointLines(plan, made, ['motor_velocity_rad_s'], { factor: 2, unit: 'x' })[0]?.y).toEqual([0, 10, 10]);
});

it('draws a limit on both sides, and that of a temperature once', () => {
	const run = { provenance: { limits: { motor_velocity_rad_s: 20, temperature_c: 80 } } };
	expect(limitLines(run, ['motor_velocity_rad_s', 'other'], ONE)[0]).toMatchObject({ valueText: '± 20 rad/s', levels: [20, -20] });
	expect(limitLines(run, ['temperature_c'], { factor: 1, unit: '°C' })[0]).toMatchObject({ valueText: '80 °C', levels: [80] });
	const both = limitLines({ provenance: { limits: { motor_current_a: 3, brake_current_a: 0.6 } } }, ['motor_current_a', 'brake_current_a'], ONE);
	expect(both.map(({ label }) => label)).toEqual(['limit, motor current', 'limit, brake current']);
	expect(both[0]!.dash).not.toEqual(both[1]!.dash);
	expect(limitLines({ provenance: {} }, ['temperature_c'], ONE)).toEqual([]);
});
