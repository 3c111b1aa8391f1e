import type { ResidualSet } from '../api/types';

/** Autocorrelation of the residuals, lag 1 first, and the 95 % band of white noise. */
export interface Autocorrelation {
	lags: number[];
	band: number;
	/** Number of points. */
	n: number;
}

/** Distribution of the residuals. */
export interface Distribution {
	skewness: number;
	/** Excess over the normal distribution. */
	kurtosis: number;
	normal: boolean;
}

const LAGS = 20;
/** Fewer points are not sufficient. */
const MIN_POINTS = 30;
/** 95 % point of χ² with two degrees of freedom. */
const CHI2_2 = 5.991;

/** The residuals of the points that count, in the order of measurement. */
export function inTimeOrder(set: ResidualSet, counted: Uint8Array): number[] {
	const time = set.axes.find((axis) => axis.name === 'time_s')?.values;
	const places = set.error.flatMap((_, i) => (counted[i] ? [i] : []));
	if (time) places.sort((a, b) => time[a]! - time[b]!);
	return places.map((i) => set.error[i]!);
}

/**
 * Autocorrelation with the band of white residuals (Ljung 1999, section 16.6); `null` with too
 * few points.
 */
export function autocorrelation(residual: readonly number[]): Autocorrelation | null {
	const n = residual.length;
	if (n < MIN_POINTS) return null;
	const [centred, power] = centre(residual);
	if (power === 0) return null;
	const lags = Array.from({ length: Math.min(LAGS, Math.floor(n / 4)) }, (_, k) => {
		let sum = 0;
		for (let i = k + 1; i < n; i++) sum += centred[i]! * centred[i - k - 1]!;
		return sum / power;
	});
	return { lags, band: 1.96 / Math.sqrt(n), n };
}

/** Whether all lags together agree with white noise at 95 % (Ljung and Box 1978). */
export function isWhite({ lags, n }: Autocorrelation): boolean {
	const h = lags.length;
	const q = n * (n + 2) * lags.reduce((sum, one, k) => sum + one ** 2 / (n - k - 1), 0);
	// The 95 % point of χ² (Wilson and Hilferty 1931).
	const spread = 2 / (9 * h);
	return q <= h * (1 - spread + 1.645 * Math.sqrt(spread)) ** 3;
}

/**
 * Skewness and kurtosis compared with those of the normal distribution (Jarque and Bera 1987); `null` with too few
 * points.
 */
export function distribution(residual: readonly number[]): Distribution | null {
	const n = residual.length;
	if (n < MIN_POINTS) return null;
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
