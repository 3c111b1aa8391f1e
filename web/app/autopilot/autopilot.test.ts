import { expect, it } from 'vitest';
import type { Autopilot, AutopilotStep } from '../api/types';
import { requestedDiagnosis, errorReduction, workbenchRun, running, displayedSteps } from './autopilot';

const step = (action: AutopilotStep['action'], more: Partial<AutopilotStep> = {}): AutopilotStep => ({ sequence: 1, at: '', action, text: action, ...more });
const why = { procedure: 'strokes', parameters: {}, why: 'to see the load' };
const flight = (request: object, steps: AutopilotStep[]): Autopilot =>
	({ id: 1, bench: 'b', state: 'running', request, runs: [4], steps, bench_time_s: 0, created_at: '' }) as Autopilot;

it('knows the run that is on', () => {
	expect(running(flight({}, [step('measure', { run: 4 })]))).toBe(4);
	expect(running(flight({}, [step('measure', { run: 4 }), step('measured', { run: 4 })]))).toBeNull();
});

it('finds the models of an experiment under the run that asked for it, not under its own', () => {
	expect([requestedDiagnosis(flight({ diagnosis: 7 }, [])), workbenchRun(flight({ diagnosis: 7 }, []))]).toEqual([7, null]);
	expect([requestedDiagnosis(flight({}, [])), workbenchRun(flight({}, []))]).toEqual([null, 4]);
});

it('tells start and end of a run once, with its reason', () => {
	const steps = [step('measure', { run: 4, experiment: why }), step('measured', { run: 4 }), step('fit'), step('measure', { run: 5 })];
	expect(displayedSteps(steps).map((one) => [one.action, one.experiment?.why])).toEqual([
		['measured', 'to see the load'],
		['fit', undefined],
		['measure', undefined],
	]);
});

it('compares errors only on the same data', () => {
	expect(errorReduction(step('add', { before_rms: 4, after_rms: 1 }))).toBe(0.75);
	expect(errorReduction(step('fit', { before_rms: 4, after_rms: 1 }))).toBeNull();
});
