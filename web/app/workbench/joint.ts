import type { RunSummary } from '../api/types';

/** Whether a run can be of the joint of another: from the same bench or source, and of no other unit under test. */
export function isOfJoint(run: RunSummary, other: RunSummary | undefined): boolean {
	if (!other || run.bench !== other.bench) return false;
	return !run.unit || !other.unit || run.unit.serial === other.unit.serial;
}
