/**
 * Parses formulas of the daemon, such as `τ_s·exp(−(|ω|/ω_s)^δ)·sign ω`, for MathML. Words between formulas stay words.
 * The formula stays on one line without stacked fractions, so that the drawing adds no interpretation to the text.
 */
export type Node =
	| { is: 'name' | 'number' | 'sign' | 'function' | 'words'; text: string }
	| { is: 'group'; open: string; close: string; inner: Node[] }
	| { is: 'raised'; base: Node; sub: Node | null; sup: Node | null };

const FUNCTIONS = new Set(['sign', 'exp', 'tanh', 'cos', 'sin', 'sqrt', 'abs']);
const RAISED = new Map([...'⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻'].map((letter, i) => [letter, '0123456789+−'[i]!]));
const LOWERED = '₀₁₂₃₄₅₆₇₈₉';
const TOKEN = /\s+|\d+(?:\.\d+)?|°?[A-Za-zα-ωΑ-Ω][A-Za-zα-ωΑ-Ω\u0307]*|_[A-Za-z0-9α-ωΑ-Ω±]+|[⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻]+|[₀₁₂₃₄₅₆₇₈₉]+|./gu;
const OPENS = new Map([
	['(', ')'],
	['[', ']'],
]);

function tokensOf(text: string): string[] {
	return [...text.matchAll(TOKEN)].flatMap(([part]) => {
		if (part.trim() === '') return [];
		// Adjacent letters: a word, or several quantities as in `pθ` and `dθ`.
		const letters = /^[A-Za-zα-ωΑ-Ω]{2}/u.test(part) && !isWord(part);
		return letters ? part.match(/.\u0307?/gu)! : [part];
	});
}

/** Two or more Latin letters, but not `dz`. */
const isWord = (text: string) => /^[A-Za-z]{2,}$/.test(text) && !/^d[A-Za-z]$/.test(text);

export function parseFormula(text: string): Node[] {
	const tokens = tokensOf(text);
	let at = 0;
	const word = (i: number) => isWord(tokens[i] ?? '') && !FUNCTIONS.has(tokens[i]!);

	function atom(): Node {
		const text = tokens[at]!;
		const article = text === 'a' && word(at - 1) && word(at + 1);
		at += 1;
		const close = text === '|' ? '|' : OPENS.get(text);
		if (close !== undefined) {
			const inner = row(close);
			if (tokens[at] === close) at += 1;
			return { is: 'group', open: text, close, inner };
		}
		if (/^\d/.test(text)) return { is: 'number', text };
		if (FUNCTIONS.has(text)) return { is: 'function', text };
		if (article || isWord(text)) return { is: 'words', text };
		if (/^°?[A-Za-zα-ωΑ-Ω]/u.test(text)) return { is: 'name', text };
		return { is: 'sign', text };
	}

	/** Subscript and superscript of the atom before. */
	function raised(base: Node): Node {
		let [sub, sup]: [Node | null, Node | null] = [null, null];
		for (;;) {
			const text = tokens[at] ?? '';
			if (text.startsWith('_') && text.length > 1) sub = { is: 'name', text: text.slice(1) };
			else if (LOWERED.includes(text[0] ?? ' ')) sub = { is: 'number', text: [...text].map((letter) => LOWERED.indexOf(letter)).join('') };
			else if (RAISED.has(text[0]!)) sup = { is: 'number', text: [...text].map((letter) => RAISED.get(letter)).join('') };
			else if (text === '^' && at + 1 < tokens.length) {
				at += 1;
				sup = raised(atom());
				continue;
			} else break;
			at += 1;
		}
		return sub || sup ? { is: 'raised', base, sub, sup } : base;
	}

	function row(until: string | null): Node[] {
		const nodes: Node[] = [];
		while (at < tokens.length) {
			const text = tokens[at]!;
			// A bar closes after an atom, and opens after a sign.
			if (until !== null && text === until && (until !== '|' || nodes.at(-1)?.is !== 'sign')) break;
			const before = nodes.at(-1);
			const next = raised(atom());
			if (next.is === 'words' && before?.is === 'words') before.text += ` ${next.text}`;
			else nodes.push(next);
		}
		return nodes;
	}

	return row(null);
}

/** A part that stays on one line: words, or a formula up to its comma. */
export type FormulaPart = { words: string } | { nodes: Node[] };

/** Words, also in brackets. */
function wordsOf(node: Node): string | null {
	if (node.is === 'words') return node.text;
	const only = node.is === 'group' && node.inner.length === 1 ? node.inner[0]! : null;
	return node.is === 'group' && only?.is === 'words' ? node.open + only.text + node.close : null;
}

/** A formula may be broken at its words, and after a comma or a semicolon. */
export function splitAtWords(nodes: readonly Node[]): FormulaPart[] {
	const list: FormulaPart[] = [];
	let open: Node[] | null = null;
	for (const node of nodes) {
		const words = wordsOf(node);
		const ends = node.is === 'sign' && /[,;]/.test(node.text);
		const last = list.at(-1);
		if (words !== null) list.push({ words });
		else if (open) open.push(node);
		else if (ends && last && 'words' in last) last.words += node.text;
		else list.push({ nodes: (open = [node]) });
		if (words !== null || ends) open = null;
	}
	return list;
}
