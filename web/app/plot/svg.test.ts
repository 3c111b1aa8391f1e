import { expect, it } from 'vitest';
import type { Curve } from './chart';
import { svgOf } from './svg';

const NOTHING = { gaps: [], region: null, band: null, notes: [] };
const frame = { xTitle: 'time [s]', yTitle: 'a < b [Nm]', x: [0, 10] as [number, number], y: [0, 100] as [number, number], width: 286, height: 170 };
const curve = (mark: Curve['mark']) => ({ label: 'set', unit: 'Nm', mark, stroke: '--oi-blue' }) as Curve;
const pathOf = (svg: string) => [...svg.matchAll(/<path d="([^"]+)" fill="none" stroke="--oi-blue"/g)].map((found) => found[1]!)[0]!;

it('draws what the axes show, broken at gaps and at what is missing', () => {
	const data = [[-5, 0, 5, 10, 20, 30], [0, 0, 50, 100, null, 3]];
	const svg = svgOf({ ...frame, curves: [curve('line')], data, backdrop: { ...NOTHING, gaps: [[5, 10]] } }, (name) => name);
	// 200 px for 10 s and 100 px for 100 Nm, from the corner at (76, 126).
	expect(pathOf(svg)).toBe('M-24 126L76 126L176 76M276 26');
	expect(svg).toContain('a &#60; b [Nm]');
});

it('marks single points, and the band that repeats fill', () => {
	const data = [[2], [50]];
	expect(svgOf({ ...frame, curves: [curve('dot')], data, backdrop: NOTHING }, (name) => name)).toContain('M113.5 76a2.5');
	const dashed = svgOf({ ...frame, curves: [{ ...curve('dash'), spread: 10 }], data, backdrop: NOTHING }, (name) => name);
	expect(dashed).toContain('M111 66h10v20h-10Z');
	expect(pathOf(dashed)).toBe('M111 76h10');
});
