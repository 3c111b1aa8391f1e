import { expect, test } from 'vitest';
import { isCurve, parseCurve } from './curve';

test('a curve is read in the usual forms of a table', () => {
	const points = [
		[0, 0],
		[0.5, 0.2],
		[1, -0.25],
	];
	for (const text of ['time_s,v\n0,0\n0.5,0.2\n1,-0.25\n', '0;0\r\n0,5;0,2\r\n1;−0,25', '# by hand\n0 0\n0.5\t0.2\n1  -0.25\n']) {
		expect(parseCurve(text)).toEqual({ points, error: null });
	}
});

test('a wrong line is named', () => {
	expect(parseCurve('t,v\n0,0\n0.5,fast\n').error).toContain('line 3');
	expect(parseCurve('0,0\n1\n').error).toContain('line 2');
	expect(parseCurve('title only').error).toContain('two columns of numbers');
});

test('a list of numbers is no curve', () => {
	expect([isCurve([[0, 1]]), isCurve([0, 1]), isCurve([]), isCurve('file')]).toEqual([true, false, false, false]);
});
