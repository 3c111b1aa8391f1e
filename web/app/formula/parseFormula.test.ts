import { expect, it } from 'vitest';
import { type Node, splitAtWords, parseFormula } from './parseFormula';

/** Converts the nodes back to one line that marks how the text was parsed. */
function say(nodes: readonly Node[]): string {
	return nodes
		.map((node) => {
			if (node.is === 'group') return `${node.open}${say(node.inner)}${node.close}`;
			if (node.is === 'raised') return `${say([node.base])}${node.sub ? `_{${say([node.sub])}}` : ''}${node.sup ? `^{${say([node.sup])}}` : ''}`;
			return node.is === 'words' ? `"${node.text}"` : node.is === 'function' ? `\\${node.text} ` : node.text;
		})
		.join('');
}

it.each([
	['τ_link/N', 'τ_{link}/N'],
	['τ_s·exp(−(|ω|/ω_s)^δ)·sign ω', 'τ_{s}·\\exp (−(|ω|/ω_{s})^{δ})·\\sign ω'],
	['c_α·|ω|^α·sign ω, α < 1', 'c_{α}·|ω|^{α}·\\sign ω,α<1'],
	['μ_2·(τ_link/N)²·sign ω', 'μ_{2}·(τ_{link}/N)^{2}·\\sign ω'],
	['τ_0, that is τ_c⁺ = τ_c + τ_0', 'τ_{0},"that is"τ_{c}^{+}=τ_{c}+τ_{0}'],
	['φ_h·(√(1 + |τ|/τ_h) − 1)·sign τ', 'φ_{h}·(√(1+|τ|/τ_{h})−1)·\\sign τ'],
	['dz = (1 − z·sign ω)·dθ/θ_p (Dahl); or a stop', 'dz=(1−z·\\sign ω)·dθ/θ_{p}("Dahl");"or a stop"'],
	['c·cos 2pθ', 'c·\\cos 2pθ'],
	['μ·|τ_link/N|·ω', 'μ·|τ_{link}/N|·ω'],
	['c_T·(T − 25 °C)·ω', 'c_{T}·(T−25°C)·ω'],
	['θ̇_s', 'θ̇_{s}'],
	['dT/dω', 'dT/dω'],
	['β₀·sign ω', 'β_{0}·\\sign ω'],
	['k_m·|−x|', 'k_{m}·|−x|'],
	['n_±', 'n_{±}'],
])('%s', (text, said) => expect(say(parseFormula(text))).toBe(said));

it('ends on whatever is written', () => {
	for (const text of ['', '(', '|', ')|(', 'a^', '_', '^^', '|a', 'exp(']) expect(say(parseFormula(text)).length).toBeLessThan(20);
});

it('may be broken at words and after commas', () => {
	const said = splitAtWords(parseFormula('s·τ³, that is k_m falls by s·τ² (Dahl); or a stop, dz')).map((piece) => ('words' in piece ? piece.words : say(piece.nodes)));
	expect(said).toEqual(['s·τ^{3},', 'that is', 'k_{m}', 'falls by', 's·τ^{2}', '(Dahl);', 'or a stop,', 'dz']);
});
