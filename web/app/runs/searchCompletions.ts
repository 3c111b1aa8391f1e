/** The search terms that the daemon supports. */
const TERMS = ['bench:', 'procedure:', 'kind:', 'state:', 'safe:', 'unit:', 'part:', 'batch:', 'operator:', 'verdict:', 'limits:', 'tag:', 'note:', 'simulated:yes', 'simulated:no', 'after:', 'before:', 'id>', 'rows>', 'duration>'];

/** Possible completions of the last search term; `values`: known values of a key. Each completion is the whole text. */
export function searchCompletions(text: string, values: Record<string, readonly string[]>): string[] {
	const head = text.slice(0, text.lastIndexOf(' ') + 1);
	const last = text.slice(head.length);
	const not = last.startsWith('-') ? '-' : '';
	const term = last.slice(not.length).toLowerCase();
	const key = /^([a-z]+):/.exec(term)?.[1];
	const known = key === undefined ? TERMS : (values[key] ?? []).map((value) => `${key}:${/\s/.test(value) ? `"${value}"` : value}`);
	return known.filter((one) => one.toLowerCase().startsWith(term) && one !== term).map((one) => head + not + one);
}
