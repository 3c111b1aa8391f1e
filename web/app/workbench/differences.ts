import type { Model, Parameter } from '../api/types';

/** One parameter in two versions. */
export interface Difference {
	key: string;
	mine: Parameter | null;
	theirs: Parameter | null;
	/** `same`: each value lies in the other's interval. `apart`: the intervals do not meet. */
	word: 'new' | 'gone' | 'same' | 'overlap' | 'apart' | 'unknown';
}

export function differences(mine: Model, theirs: Model): Difference[] {
	const byKey = (model: Model) => new Map(model.fit.parameters.map((p) => [`${p.effect}.${p.name}`, p]));
	const [a, b] = [byKey(mine), byKey(theirs)];
	return [...new Set([...a.keys(), ...b.keys()])].map((key) => {
		const [one, two] = [a.get(key) ?? null, b.get(key) ?? null];
		return { key, mine: one, theirs: two, word: wordFor(one, two) };
	});
}

function wordFor(mine: Parameter | null, theirs: Parameter | null): Difference['word'] {
	if (!mine) return 'new';
	if (!theirs) return 'gone';
	const [low, high, from, to] = [...mine.ci95, ...theirs.ci95];
	if (low == null || high == null || from == null || to == null) return 'unknown';
	if (high < from || to < low) return 'apart';
	return low <= theirs.value && theirs.value <= high && from <= mine.value && mine.value <= to ? 'same' : 'overlap';
}
