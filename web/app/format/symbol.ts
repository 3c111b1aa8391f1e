/** Symbols of model parameters, as in the formulas of their effects and in the results of runs. */

const GREEK: Record<string, string> = { alpha: 'α', beta: 'β', delta: 'δ', eta: 'η', kappa: 'κ', mu: 'μ', omega: 'ω', phi: 'φ', rho: 'ρ', tau: 'τ', theta: 'θ', xi: 'ξ' };
const OWN: Record<string, string> = { j: 'J', inverse_k: "k'⁻¹", harmonic: 'h', pole_pairs: 'p' };

/** `tau_c` → `τ_c`, `c_t_tau` → `c_Tτ`. A lower `t` is the temperature, except in the time constants `t_…`. */
export function parameterSymbol(name: string): string {
	const [base = '', ...lower] = name.split('_');
	const subscript = lower.map((part) => GREEK[part] ?? (part === 't' ? 'T' : part)).join('');
	return OWN[name] ?? `${GREEK[base] ?? base}${subscript && `_${subscript}`}`;
}
