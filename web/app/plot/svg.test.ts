import { expect, it } from 'vitest';
import { EMPTY_BACKDROP } from './backdrop';
import type { Curve } from './chart';
import { svgOf } from './svg';

const frame = { xTitle: 'time [s]', yTitle: 'a < b [Nm]', x: [0, 10] as [number, number], y: [0, 100] as [number, number], width: 286, height: 170 };
const curve = (mark: Curve['mark']) => ({ label: 'set', unit: 'Nm', mark, stroke: '--oi-blue' }) as Curve;
const pathOf = (svg: string) => [...svg.matchAll(/<path d="([^"]+)" fill="none" stroke="--oi-blue"/g)].map((found) => found[1]!)[0]!;

it('draws what the axes show, broken at gaps and at what is missing', () => {
	const data = [[-5, 0, 5, 10, 20, 30], [0, 0, 50, 100, null, 3]];
	const svg = svgOf({ ...frame, curves: [curve('line')], data, backdrop: { ...EMPTY_BACKDROP, gaps: [[5, 10]] } }, (name) => name);
	// 200 px for 10 s and 100 px for 100 Nm, from the corner at (76, 126).
	expect(pathOf(svg)).toBe('M-24 126L76 126L176 76M276 26');
	expect(svg).toContain('a &#60; b [Nm]');
});

it('marks single points, and the band that repeats fill', () => {
	const data = [[2], [50]];
	expect(svgOf({ ...frame, curves: [curve('dot')], data, backdrop: EMPTY_BACKDROP }, (name) => name)).toContain('M113.5 76a2.5');
	const dashed = svgOf({ ...frame, curves: [{ ...curve('dash'), spread: 10 }], data, backdrop: EMPTY_BACKDROP }, (name) => name);
	expect(dashed).toContain('M111 66h10v20h-10Z');
	expect(pathOf(dashed)).toBe('M111 76h10');
});

it('draws steps, limits and set points behind the curves, and says so in the legend', () => {
	const limit = { label: 'limit', valueText: '± 80 Nm', stroke: '--warn', dash: [6, 3], levels: [80, -80], x: [], y: [] };
	const set = { label: 'set point', valueText: '', stroke: '--soft', dash: [2, 2], levels: [], x: [0, 5], y: [0, 50] };
	const svg = svgOf({ ...frame, curves: [curve('line')], data: [[0, 10], [1, 2]], backdrop: { ...EMPTY_BACKDROP, steps: [0, 5, 10], lines: [limit, set] } }, (name) => name);
	expect(svg).toContain('<rect x="176" y="26" width="100" height="100" fill="--step"/>');
	expect(svg).toContain('d="M76 46H276M76 206H276" fill="none" stroke="--warn"');
	expect(svg).toContain('d="M76 126L176 76" fill="none" stroke="--soft"');
	expect(svg).toContain('limit ± 80 Nm');
});

it('writes powers of ten where the values are their logarithms', () => {
	const svg = svgOf({ ...frame, y: [-3, 0], log: true, curves: [curve('line')], data: [[0, 10], [-3, 0]], backdrop: EMPTY_BACKDROP }, (name) => name);
	expect(svg).toContain('>0.001<');
	expect(svg).toContain('>1<');
});
