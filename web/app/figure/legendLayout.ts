/** Entries of a legend on paper, side by side if they fit. */
const LETTER = 6.4;
const SAMPLE = 26;
const GAP = 14;
export const ROW = 17;

export interface LegendEntry {
	x: number;
	y: number;
}

export function legendLayout(labels: readonly string[], width: number): { entries: LegendEntry[]; height: number } {
	let [x, row] = [0, 0];
	const entries = labels.map((label) => {
		const entryWidth = SAMPLE + label.length * LETTER;
		if (x > 0 && x + entryWidth > width) [x, row] = [0, row + 1];
		const entry = { x, y: row * ROW };
		x += entryWidth + GAP;
		return entry;
	});
	return { entries, height: labels.length ? (row + 1) * ROW : 0 };
}
