import { formatCountdown } from '../format/time';
import type { Progress } from '../api/types';

/** The active step, from 1: the daemon counts finished steps. */
export function activeStep({ step, steps }: Progress): number {
	return Math.min(step + 1, steps);
}

/** A warm-up ends as soon as the joint is steady. */
export const remainingText = ({ remaining_s, at_most }: Progress): string => (at_most ? 'at most ' : '') + formatCountdown(remaining_s);

export const stepText = (progress: Progress): string => `step ${activeStep(progress)} of ${progress.steps}, ${remainingText(progress)} left`;
