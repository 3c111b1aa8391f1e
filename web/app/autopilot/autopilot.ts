import type { Autopilot, AutopilotStep } from '../api/types';
import type { StatusLabel } from '../ui/states';

const STATE_LABELS: Record<Autopilot['state'], StatusLabel> = {
	running: { label: 'ON', icon: '▶', tone: 'busy' },
	finished: { label: 'DONE', icon: '✓', tone: 'good' },
	budget_spent: { label: 'BUDGET SPENT', icon: '◔', tone: 'warn' },
	stopped: { label: 'STOPPED', icon: '■', tone: 'warn' },
	failed: { label: 'FAILED', icon: '✕', tone: 'bad' },
	interrupted: { label: 'INTERRUPTED', icon: '⚡', tone: 'bad' },
};

export const autopilotStateLabel = (state: Autopilot['state']) => STATE_LABELS[state];

/** The diagnosis whose recommended run it makes; `null` for an autopilot that continues until no effect is missing. */
export function requestedDiagnosis(autopilot: Autopilot): number | null {
	const diagnosis = autopilot.request['diagnosis'];
	return typeof diagnosis === 'number' ? diagnosis : null;
}

/** The run whose workbench shows its models: further runs are fitted together with the first one. */
export function workbenchRun(autopilot: Autopilot): number | null {
	return requestedDiagnosis(autopilot) === null ? ((autopilot.request['from_run'] as number | undefined) ?? autopilot.runs[0] ?? null) : null;
}

/** The active run, or `null` between runs. */
export function running(autopilot: Autopilot): number | null {
	const last = autopilot.state === 'running' ? autopilot.steps.at(-1) : undefined;
	return last?.action === 'measure' ? (last.run ?? null) : null;
}

/** Steps for display: the start and the end of a run become one step after the run has ended. */
export function displayedSteps(steps: readonly AutopilotStep[]): AutopilotStep[] {
	return steps.flatMap((step, i) => {
		const next = steps[i + 1];
		if (step.action === 'measure' && next?.action === 'measured') return [];
		const started = steps[i - 1];
		return [step.action === 'measured' && started?.experiment ? { ...step, experiment: started.experiment } : step];
	});
}

/** Relative reduction of the validation error by a step; unknown if the errors are of different data. */
export function errorReduction({ action, before_rms, after_rms }: AutopilotStep): number | null {
	return action === 'add' && before_rms && after_rms != null ? 1 - after_rms / before_rms : null;
}
