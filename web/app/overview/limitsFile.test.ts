import { expect, it } from 'vitest';
import { loadLimitsFile, saveLimitsFile } from './limitsFile';

function storage(initial: Record<string, string> = {}) {
	const values = new Map(Object.entries(initial));
	return { getItem: (key: string) => values.get(key) ?? null, setItem: (key: string, text: string) => void values.set(key, text), removeItem: (key: string) => void values.delete(key) };
}

it('keeps the limits file until it is removed', () => {
	const kept = storage();
	expect(loadLimitsFile(kept)).toBeNull();
	const file = { name: 'limits.toml', text: '[[limit]]' };
	saveLimitsFile(file, kept);
	expect(loadLimitsFile(kept)).toEqual(file);
	saveLimitsFile(null, kept);
	expect(loadLimitsFile(kept)).toBeNull();
});

it('ignores what another version stored', () => {
	for (const text of ['{', '"text"', '{"name": 1, "text": "x"}']) expect(loadLimitsFile(storage({ 'jointbench.limits': text }))).toBeNull();
});
