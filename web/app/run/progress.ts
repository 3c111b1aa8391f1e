import { countdown } from '../format/time';
import type { Progress } from '../api/types';

/** The active step, from 1: the daemon counts finished steps. */
export function stepOn({ step, steps }: Progress): number {
	return Math.min(step + 1, steps);
}

/** A warm-up ends as soon as the joint is steady. */
export const sayLeft = ({ remaining_s, at_most }: Progress): string => (at_most ? 'at most ' : '') + countdown(remaining_s);

export const sayStep = (progress: Progress): string => `step ${stepOn(progress)} of ${progress.steps}, ${sayLeft(progress)} left`;
