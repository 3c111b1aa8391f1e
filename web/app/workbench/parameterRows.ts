import type { Parameter, TradeOff } from '../api/types';

/** A parameter on a scale of its own value: 0 is zero, 1 is the estimate. */
export interface ParameterRow {
	parameter: Parameter;
	/** Ends of the interval in multiples of the value; `null` if the data gives none. */
	interval: [number, number] | null;
	/** Magnification of a narrow interval: a power of ten. */
	zoom: number;
	flags: string[];
}

const STATE_TEXTS: Partial<Record<Parameter['state'], string>> = { at_bound: 'at its bound', fixed: 'fixed', impossible: 'contradicts physics', unidentified: 'not decided by this data' };

/** Correlation from which two parameters are flagged as a trade-off. */
const MIN_CORRELATION = 0.9;

/** Largest distance from the estimate on the scale, in multiples of it. */
export const HALF_WIDTH = 1.3;

export function parameterRows(parameters: readonly Parameter[], tradeOffs: readonly TradeOff[] = [], nameOf: (id: string) => string = (id) => id): ParameterRow[] {
	return parameters.map((parameter) => {
		const { value, ci95 } = parameter;
		const [low, high] = [ci95[0] ?? Number.NaN, ci95[1] ?? Number.NaN];
		const known = Number.isFinite(low) && Number.isFinite(high);
		const flags: string[] = [];
		const name = `${parameter.effect}.${parameter.name}`;
		for (const { first, second, correlation } of tradeOffs) {
			if (Math.abs(correlation) < MIN_CORRELATION || (name !== first && name !== second)) continue;
			flags.push(`ρ ${correlation.toFixed(2).replace('-', '−')} with ${nameOf(name === first ? second : first)}`);
		}
		const state = STATE_TEXTS[parameter.state];
		// The daemon's own note has priority over the text here.
		if (parameter.note) flags.push(parameter.note);
		else if (state) flags.push(state);
		if (!known) flags.push('no interval');
		if (known && low < 0 && high > 0 && !parameter.note) flags.push('may be zero');
		// A parameter chosen among whole numbers is known exactly and has no interval.
		if (value === 0 || !known || low === high) return { parameter, interval: null, zoom: 1, flags };
		const ends = [low / value, high / value].sort((a, b) => a - b) as [number, number];
		const widest = Math.max(1 - ends[0], ends[1] - 1);
		return { parameter, interval: ends, zoom: 10 ** Math.max(0, Math.floor(Math.log10(HALF_WIDTH / widest))), flags };
	});
}
