/** Entries of a legend on paper, side by side if they fit. */
const LETTER = 6.4;
const SAMPLE = 26;
const GAP = 14;
export const ROW = 17;

export interface Entry {
	x: number;
	y: number;
}

export function flow(labels: readonly string[], width: number): { entries: Entry[]; height: number } {
	let [x, row] = [0, 0];
	const entries = labels.map((label) => {
		const long = SAMPLE + label.length * LETTER;
		if (x > 0 && x + long > width) [x, row] = [0, row + 1];
		const entry = { x, y: row * ROW };
		x += long + GAP;
		return entry;
	});
	return { entries, height: labels.length ? (row + 1) * ROW : 0 };
}
