import { expect, it } from 'vitest';
import type { Run } from '../api/types';
import { archivedReason } from './archivedSamples';

const table = (more: object) => ({ run: 1, content: 'samples', state: 'archived', file: '/a/run-1.parquet', ...more }) as NonNullable<Run['archive']>[number];

it('names the file of samples that are only in the archive', () => {
	expect(archivedReason({ archive: [table({ dropped_at: '2026-01-01T00:00:00Z' })] })).toContain('/a/run-1.parquet');
});

it('has no reason while the run has its samples', () => {
	expect(archivedReason({})).toBeNull();
	expect(archivedReason({ archive: [table({})] })).toBeNull();
	expect(archivedReason({ archive: [table({ content: 'means', dropped_at: '2026-01-01T00:00:00Z' })] })).toBeNull();
});
