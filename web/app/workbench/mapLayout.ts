import type { Bins } from '../residual/bins';
import type { ResidualMap } from '../residual/map';
import { type AxisScale, binMiddle, axisScale } from '../residual/axisScale';

export const MARGIN = { left: 58, right: 6, top: 6, bottom: 38 };
export const PALETTE = ['--map-lowest', '--map-low', '--map-mid', '--map-high', '--map-highest'];

/** Room for a number below the map. */
const TICK_PX = 44;

export function mapAxes(map: ResidualMap, width: number, height: number): { x: AxisScale; y: AxisScale } {
	const room = Math.max(2, Math.floor((width - MARGIN.left - MARGIN.right) / TICK_PX));
	return {
		x: axisScale(map.x, MARGIN.left, width - MARGIN.right, Math.min(room, map.x.setPoints ? 14 : 8)),
		y: axisScale(map.y, height - MARGIN.bottom, MARGIN.top, map.y.setPoints ? 9 : 5),
	};
}

export const tickPosition = (bins: Bins, scale: AxisScale, tick: number): number => (bins.setPoints ? binMiddle(bins, scale, bins.setPoints.indexOf(tick)) : scale.at(tick));

/** Both ends in order, with a visible minimum distance. */
export function withMinimumWidth([a = 0, b = 0]: number[]): [number, number] {
	const [low, high] = [Math.min(a, b), Math.max(a, b)];
	const lack = Math.max(0, 8 - (high - low)) / 2;
	return [low - lack, high + lack];
}

interface Box {
	x: number;
	y: number;
	width: number;
	height: number;
}

export const rectanglePath = ({ x, y, width, height }: Box): string => `M${x} ${y}h${width}v${height}h${-width}Z`;

/** Hatching of a cell with too few points. */
export function hatchPath({ x, y, width, height }: Box): string {
	let strokes = '';
	for (let from = Math.floor((x - height) / 6) * 6; from < x + width; from += 6) {
		const [left, right] = [Math.max(from, x), Math.min(from + height, x + width)];
		if (right > left) strokes += `M${left} ${y + height - left + from}L${right} ${y + height - right + from}`;
	}
	return strokes;
}
