import type { Progress } from '../api/types';

/** The step that is on, from 1: the daemon counts the steps that are done. */
export function stepOn({ step, steps }: Progress): number {
	return Math.min(step + 1, steps);
}
