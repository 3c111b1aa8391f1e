import { ENOUGH, type Tally, score } from './tally';

/** What the colour of a cell tells, and how it grows: no end of the scale is reached before the worst cell. */
export interface Shading {
	/** Mean in standard errors, or the mean itself. */
	of: 'errors' | 'value';
	log: boolean;
}

/** `value-linear`, as the address carries it; standard errors on a logarithmic scale where left out. */
export function readShading(text: string | null): Shading {
	const [of, scale] = (text ?? '').split('-');
	return { of: of === 'value' ? 'value' : 'errors', log: scale !== 'linear' };
}

export const writeShading = ({ of, log }: Shading): string | null => (of === 'errors' && log ? null : `${of}-${log ? 'log' : 'linear'}`);

/** What is told of a cell; `null` where there are too few points. */
export const toldOf = (cell: Tally, of: Shading['of']): number | null => (of === 'errors' ? score(cell) : cell.n < ENOUGH ? null : cell.mean);

/** Standard errors to which a scale goes at least: a map of noise alone is pale. */
const PALE = 5;

/** The end of the scale: the worst cell, and no less than what noise alone reaches; `noise` in the unit of the residual. */
export function reachOfMap(cells: readonly Tally[], of: Shading['of'], noise: number): number {
	const least = of === 'errors' ? PALE : noise;
	return cells.reduce((most, cell) => Math.max(most, Math.abs(toldOf(cell, of) ?? 0)), least) || 1;
}

/** Where a logarithmic scale turns linear about zero: one standard error, or a fiftieth of the worst. */
const turn = (most: number, of: Shading['of']) => (of === 'errors' ? 1 : most / 50);

/** How deep the colour is, from −2 to 2 at the ends of the scale. */
export function depth(value: number, most: number, { of, log }: Shading): number {
	const share = Math.min(1, Math.abs(value) / most);
	const at = turn(most, of);
	return 2 * Math.sign(value) * (log ? Math.log1p((share * most) / at) / Math.log1p(most / at) : share);
}

/** The value at which the colour is so deep: the way back, for the ticks of the scale. */
export function atDepth(deep: number, most: number, { of, log }: Shading): number {
	const share = Math.abs(deep) / 2;
	const at = turn(most, of);
	return Math.sign(deep) * (log ? at * Math.expm1(share * Math.log1p(most / at)) : share * most);
}
