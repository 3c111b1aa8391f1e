import { expect, it } from 'vitest';
import { parameterSymbol } from './symbol';

it('writes a parameter as in the formula of its effect', () => {
	expect(['tau_c', 'c_v', 'j', 'inverse_k', 'beta_0', 'xi', 'omega_s', 'c_t', 't_d', 'c_t_tau', 'c_alpha', 'a'].map(parameterSymbol)).toEqual(['τ_c', 'c_v', 'J', "k'⁻¹", 'β_0', 'ξ', 'ω_s', 'c_T', 't_d', 'c_Tτ', 'c_α', 'a']);
});
