import { expect, it } from 'vitest';
import { parameterSymbol } from './symbol';

it('has the symbol of the effect, also for a member of a family', () => {
	const parameters = [['tau_c', 'τ_c'], ['c_2', 'c_2'], ['xi', 'ξ'], ['c_t', 'c_T']].map(([name = '', symbol = '']) => ({ name, symbol, unit: '1' }));
	const symbols = ['tau_c', 'c_2', 'xi_2', 'c_t1', 'unknown_3'].map((name) => parameterSymbol({ parameters }, name));
	expect(symbols).toEqual(['τ_c', 'c_2', 'ξ_2', 'c_T1', 'unknown_3']);
	expect(parameterSymbol(undefined, 'tau_c')).toBe('tau_c');
});
