import type { Autopilot, AutopilotStep } from '../api/types';
import type { Mood } from '../ui/states';

const ENDS: Record<Autopilot['state'], { word: string; icon: string; mood: Mood }> = {
	running: { word: 'ON', icon: '▶', mood: 'busy' },
	finished: { word: 'DONE', icon: '✓', mood: 'good' },
	budget_spent: { word: 'BUDGET SPENT', icon: '◔', mood: 'warn' },
	stopped: { word: 'STOPPED', icon: '■', mood: 'warn' },
	failed: { word: 'FAILED', icon: '✕', mood: 'bad' },
	interrupted: { word: 'INTERRUPTED', icon: '⚡', mood: 'bad' },
};

export const sayEnd = (state: Autopilot['state']) => ENDS[state];

/** The diagnosis whose recommended run it makes; `null` for an autopilot that continues until no effect is missing. */
export function asked(flight: Autopilot): number | null {
	const diagnosis = flight.request['diagnosis'];
	return typeof diagnosis === 'number' ? diagnosis : null;
}

/** The run whose workbench shows its models: further runs are fitted together with the first one. */
export function home(flight: Autopilot): number | null {
	return asked(flight) === null ? ((flight.request['from_run'] as number | undefined) ?? flight.runs[0] ?? null) : null;
}

/** The active run, or `null` between runs. */
export function running(flight: Autopilot): number | null {
	const last = flight.state === 'running' ? flight.steps.at(-1) : undefined;
	return last?.action === 'measure' ? (last.run ?? null) : null;
}

/** Steps for display: the start and the end of a run become one step after the run has ended. */
export function told(steps: readonly AutopilotStep[]): AutopilotStep[] {
	return steps.flatMap((step, i) => {
		const next = steps[i + 1];
		if (step.action === 'measure' && next?.action === 'measured') return [];
		const begun = steps[i - 1];
		return [step.action === 'measured' && begun?.experiment ? { ...step, experiment: begun.experiment } : step];
	});
}

/** Relative reduction of the validation error by a step; unknown if the errors are of different data. */
export function fall({ action, before_rms, after_rms }: AutopilotStep): number | null {
	return action === 'add' && before_rms && after_rms != null ? 1 - after_rms / before_rms : null;
}
