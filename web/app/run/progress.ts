import { countdown } from '../format/time';
import type { Progress } from '../api/types';

/** The step that is on, from 1: the daemon counts the steps that are done. */
export function stepOn({ step, steps }: Progress): number {
	return Math.min(step + 1, steps);
}

export const sayStep = (progress: Progress): string => `step ${stepOn(progress)} of ${progress.steps}, ${countdown(progress.remaining_s)} left`;
