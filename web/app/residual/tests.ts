import type { ResidualSet } from '../api/types';

/** How much points that follow each other have in common, lag 1 first, and what chance alone stays within at 95 %. */
export interface Dependence {
	lags: number[];
	band: number;
	/** How many points there are. */
	n: number;
}

/** What the residuals' own distribution says. */
export interface Shape {
	skewness: number;
	/** Beyond that of the normal distribution. */
	kurtosis: number;
	normal: boolean;
}

const LAGS = 20;
/** Fewer points say nothing. */
const ENOUGH = 30;
/** 95 % point of χ² with two degrees of freedom. */
const CHI2_2 = 5.991;

/** The residuals of the points that count, in the order in which they were measured. */
export function inOrder(set: ResidualSet, kept: Uint8Array): number[] {
	const time = set.axes.find((axis) => axis.name === 'time_s')?.values;
	const places = set.error.flatMap((_, i) => (kept[i] ? [i] : []));
	if (time) places.sort((a, b) => time[a]! - time[b]!);
	return places.map((i) => set.error[i]!);
}

/** Autocorrelation with the band of white residuals (Ljung, System Identification, 1999, section 16.6); `null` for too few points. */
export function dependence(residual: readonly number[]): Dependence | null {
	const n = residual.length;
	if (n < ENOUGH) return null;
	const [centred, power] = centre(residual);
	if (power === 0) return null;
	const lags = Array.from({ length: Math.min(LAGS, Math.floor(n / 4)) }, (_, k) => {
		let sum = 0;
		for (let i = k + 1; i < n; i++) sum += centred[i]! * centred[i - k - 1]!;
		return sum / power;
	});
	return { lags, band: 1.96 / Math.sqrt(n), n };
}

/** Are all lags together what chance leaves, at 95 % (Ljung and Box, 1978)? */
export function isWhite({ lags, n }: Dependence): boolean {
	const h = lags.length;
	const q = n * (n + 2) * lags.reduce((sum, one, k) => sum + one ** 2 / (n - k - 1), 0);
	// The 95 % point of χ² (Wilson and Hilferty, 1931).
	const spread = 2 / (9 * h);
	return q <= h * (1 - spread + 1.645 * Math.sqrt(spread)) ** 3;
}

/** Skewness and kurtosis, held against the normal distribution's (Jarque and Bera, 1987); `null` for too few points. */
export function shape(residual: readonly number[]): Shape | null {
	const n = residual.length;
	if (n < ENOUGH) return null;
	const [centred, power] = centre(residual);
	if (power === 0) return null;
	const sigma = Math.sqrt(power / n);
	const moment = (order: number) => centred.reduce((sum, one) => sum + (one / sigma) ** order, 0) / n;
	const [skewness, kurtosis] = [moment(3), moment(4) - 3];
	return { skewness, kurtosis, normal: (n / 6) * (skewness ** 2 + kurtosis ** 2 / 4) <= CHI2_2 };
}

function centre(values: readonly number[]): [centred: number[], power: number] {
	const mean = values.reduce((sum, one) => sum + one, 0) / values.length;
	const centred = values.map((one) => one - mean);
	return [centred, centred.reduce((sum, one) => sum + one * one, 0)];
}
