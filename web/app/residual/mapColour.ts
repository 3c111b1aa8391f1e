import { MIN_POINTS, type BlockMean, score } from './blockMeans';

/** Quantity and scale of the colour of a cell. Only the worst cell reaches the end of the scale. */
export interface MapColour {
	/** Mean in standard errors, or the mean itself. */
	of: 'errors' | 'value';
	log: boolean;
}

/** `value-linear`, as in the address; the default is standard errors on a logarithmic scale. */
export function readMapColour(text: string | null): MapColour {
	const [of, scale] = (text ?? '').split('-');
	return { of: of === 'value' ? 'value' : 'errors', log: scale !== 'linear' };
}

export const writeMapColour = ({ of, log }: MapColour): string | null => (of === 'errors' && log ? null : `${of}-${log ? 'log' : 'linear'}`);

/** The coloured quantity of a cell; `null` if there are too few points. */
export const colouredValue = (cell: BlockMean, of: MapColour['of']): number | null => (of === 'errors' ? score(cell) : cell.n < MIN_POINTS ? null : cell.mean);

/** Smallest end of a scale in standard errors, so that a map of pure noise is pale. */
const MIN_RANGE = 5;

/** End of the scale: the worst cell, but at least the level of pure noise; `noise` in the unit of the residual. */
export function mapRange(cells: readonly BlockMean[], of: MapColour['of'], noise: number): number {
	const least = of === 'errors' ? MIN_RANGE : noise;
	return cells.reduce((most, cell) => Math.max(most, Math.abs(colouredValue(cell, of) ?? 0)), least) || 1;
}

/** Value below which a logarithmic scale is linear: one standard error, or 1/50 of the worst cell. */
const linearRange = (most: number, of: MapColour['of']) => (of === 'errors' ? 1 : most / 50);

/** Depth of the colour, −2 to 2 at the ends of the scale. */
export function colourDepth(value: number, most: number, { of, log }: MapColour): number {
	const share = Math.min(1, Math.abs(value) / most);
	const at = linearRange(most, of);
	return 2 * Math.sign(value) * (log ? Math.log1p((share * most) / at) / Math.log1p(most / at) : share);
}

/** The value of a colour depth: the inverse, for the ticks of the scale. */
export function valueAtDepth(deep: number, most: number, { of, log }: MapColour): number {
	const share = Math.abs(deep) / 2;
	const at = linearRange(most, of);
	return Math.sign(deep) * (log ? at * Math.expm1(share * Math.log1p(most / at)) : share * most);
}
