import type { Effect } from '../api/types';

/** The symbol of a parameter of an effect; the member `xi_2` of the family `xi` has its index. Its name before the effects are loaded. */
export function parameterSymbol(effect: Pick<Effect, 'parameters'> | null | undefined, name: string): string {
	const symbolOf = (of: string | undefined) => effect?.parameters.find((one) => one.name === of)?.symbol;
	const [, family, index] = /^(.*?)_?(\d+)$/.exec(name) ?? [];
	const base = symbolOf(family);
	return symbolOf(name) ?? (base ? `${base}${base.includes('_') ? '' : '_'}${index}` : name);
}
