/** The tag that keeps a run at the top of the list, for all users. */
export const PIN_TAG = 'pinned';

export const togglePin = (tags: readonly string[]): string[] => (tags.includes(PIN_TAG) ? tags.filter((tag) => tag !== PIN_TAG) : [...tags, PIN_TAG]);
