import type { Run } from '../api/types';

/** Why functions that need samples are not available: the samples of the run are only in the archive. */
export function archivedReason(run: Pick<Run, 'archive'>): string | null {
	const samples = run.archive?.find(({ content, dropped_at }) => content === 'samples' && dropped_at);
	return samples ? `The samples are only in the archive: ${samples.file ?? 'its file is not known'}. Import this file to use them.` : null;
}
