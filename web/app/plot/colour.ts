/** Colours for canvases: the custom properties of the style sheet, read once per theme. */
const known = new Map<string, string>();

export function colour(property: string): string {
	let value = known.get(property);
	if (value === undefined) {
		value = getComputedStyle(document.documentElement).getPropertyValue(property).trim();
		known.set(property, value);
	}
	return value;
}

/** Called after a change of theme. */
export function clearColourCache(): void {
	known.clear();
}

/** Colour and dash of the i-th curve: curves never differ only in colour. */
const CURVES: [string, number[]][] = [
	['--oi-blue', []],
	['--oi-vermillion', [7, 4]],
	['--oi-green', [2, 3]],
	['--oi-purple', [9, 3, 2, 3]],
	['--oi-orange', [4, 2]],
	['--oi-sky', [14, 3]],
];

export function curveStyle(i: number): { stroke: string; dash: number[] } {
	const [stroke, dash] = CURVES[i % CURVES.length]!;
	return { stroke, dash };
}

function rgb(hex: string): [number, number, number] {
	const value = Number.parseInt(hex.replace('#', ''), 16);
	return [(value >> 16) & 255, (value >> 8) & 255, value & 255];
}

/** Diverging colour scale: −1 is `low`, 0 `middle`, +1 `high`; up to ±2 `lowest` and `highest`. */
export function diverging(at: number, [lowest, low, middle, high, highest]: readonly [string, string, string, string, string]): string {
	const size = Math.min(2, Math.abs(at));
	const [full, deep] = at < 0 ? [low, lowest] : [high, highest];
	const [from, to, share] = size <= 1 ? [rgb(middle), rgb(full), size] : [rgb(full), rgb(deep), size - 1];
	const mixed = from.map((value, i) => Math.round(value + (to[i]! - value) * share));
	return `rgb(${mixed.join(' ')})`;
}
