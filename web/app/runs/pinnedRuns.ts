import { toggled } from '../state/toggled';

/** The tag that keeps a run at the top of the list, for all users. */
export const PIN_TAG = 'pinned';

export const togglePin = (tags: readonly string[]): string[] => toggled(tags, PIN_TAG);
