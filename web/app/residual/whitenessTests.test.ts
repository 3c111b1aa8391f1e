import { expect, it } from 'vitest';
import { autocorrelation, isWhite, distribution } from './whitenessTests';

/** Park and Miller's generator, with two uniform numbers for each normal one. */
function normals(count: number, seed: number): number[] {
	let state = seed;
	const uniform = () => (state = (state * 48271) % 2147483647) / 2147483647;
	return Array.from({ length: count }, () => Math.sqrt(-2 * Math.log(uniform())) * Math.cos(2 * Math.PI * uniform()));
}

it('finds white noise white nearly always', () => {
	const white = Array.from({ length: 200 }, (_, seed) => isWhite(autocorrelation(normals(400, seed + 1))!));
	expect(white.filter(Boolean).length).toBeGreaterThan(180);
});

it('sees a course, in its first lag', () => {
	const noise = normals(400, 5);
	const course = noise.map((one, i) => 0.5 * one + Math.sin(i / 30));
	const found = autocorrelation(course)!;
	expect(isWhite(found)).toBe(false);
	expect(found.lags[0]).toBeGreaterThan(0.5);
	expect(found.band).toBeCloseTo(0.098);
});

it('knows the normal distribution from one with tails or a slope', () => {
	const noise = normals(2000, 9);
	expect(distribution(noise)!.normal).toBe(true);
	expect(distribution(noise.map((one) => one ** 3))!.kurtosis).toBeGreaterThan(10);
	expect(distribution(noise.map(Math.exp))!.skewness).toBeGreaterThan(2);
	expect(distribution(noise.map(Math.exp))!.normal).toBe(false);
});

it('says nothing of a handful, or of residuals that are all the same', () => {
	expect(autocorrelation([1, 2, 3])).toBeNull();
	expect(distribution(new Array(100).fill(0.5))).toBeNull();
});
