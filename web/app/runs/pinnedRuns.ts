/** The tag that keeps a run at the top of the list, for all users. */
export const PIN = 'pinned';

export const togglePin = (tags: readonly string[]): string[] => (tags.includes(PIN) ? tags.filter((tag) => tag !== PIN) : [...tags, PIN]);
