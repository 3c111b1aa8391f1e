import { expect, test } from 'vitest';
import type { RunSummary } from '../api/types';
import { isOfJoint } from './joint';

const run = (bench: string, serial?: string) => ({ bench, ...(serial && { unit: { serial } }) }) as RunSummary;

test('runs of one bench are of one joint unless their units differ', () => {
	expect(isOfJoint(run('a'), run('a', 'SN1'))).toBe(true);
	expect(isOfJoint(run('a', 'SN1'), run('a', 'SN1'))).toBe(true);
	expect(isOfJoint(run('a', 'SN2'), run('a', 'SN1'))).toBe(false);
	expect(isOfJoint(run('b'), run('a'))).toBe(false);
});
