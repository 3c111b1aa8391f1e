import { expect, test } from 'vitest';
import type { LogEntry } from '../api/types';
import { journalGroups } from './journalGroups';

const journal = (...kinds: string[]) => kinds.map((kind, i) => ({ kind, text: String(i) }) as LogEntry);
const step = ['step_started', 'step_finished'];

test('many steps in a row are one group, events between them stay', () => {
	const groups = journalGroups(journal('note', ...step, ...step, ...step, ...step, 'warning', ...step));
	expect(groups.map((group) => ('steps' in group ? group.finished : group.entry.text))).toEqual(['0', 4, '9', '10', '11']);
	expect(journalGroups([])).toEqual([]);
});
