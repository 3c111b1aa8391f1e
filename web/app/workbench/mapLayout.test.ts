import { expect, it } from 'vitest';
import { mapAxes } from './mapLayout';

it('a narrow map labels only as many set points as have room', () => {
	const setPoints = [-11.1, -9.4, -7.2, -4.7, -2, 0, 1.8, 4.7, 7.2, 9.4, 11.1];
	const bins = { edges: [-12, ...setPoints.map((at, i) => (at + (setPoints[i + 1] ?? 13)) / 2)], setPoints };
	const ticks = (width: number) => mapAxes({ x: bins, y: bins, cells: [] }, width, 200).x.ticks;
	expect(ticks(870)).toEqual(setPoints);
	expect(ticks(340)).toEqual([-11.1, -7.2, -2, 1.8, 7.2, 11.1]);
});
