import type uPlot from 'uplot';
import { touchGestures } from './touch';

export type View = [from: number, to: number];
/**
 * The gesture that asked for a view: a live plot continues to follow after a zoom, but not after the other gestures.
 */
export type Gesture = 'zoom' | 'box' | 'pan' | 'all' | 'back';
export type OnView = (view: View | null, hand: Gesture) => void;

/**
 * Gestures on a plot: the wheel zooms around the pointer, a drag selects a range, a shift-drag moves, a double click
 * returns. The chart stores no zoom; it only reports the requested view.
 */
export function gestures(onview: OnView): Pick<uPlot.Options, 'cursor' | 'hooks'> {
	return {
		cursor: {
			drag: { x: true, y: false, setScale: false, dist: 4 },
			bind: {
				mousedown: (u, _target, handler) => (event) => {
					if (event.button === 0 && event.shiftKey) pan(u, event, onview);
					else handler(event);
					return null;
				},
				dblclick: () => () => {
					onview(null, 'back');
					return null;
				},
			},
		},
		hooks: {
			setSelect: [
				(u) => {
					if (u.select.width < 4) return;
					onview([u.posToVal(u.select.left, 'x'), u.posToVal(u.select.left + u.select.width, 'x')], 'box');
					u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
				},
			],
			ready: [(u) => u.over.addEventListener('wheel', (event) => zoom(u, event, onview), { passive: false }), (u) => touchGestures(u, onview), (u) => keyboardGestures(u, onview)],
		},
	};
}

/** Movement of both ends of the view per key, as fractions of its width. */
const MOVES: Partial<Record<string, [from: number, to: number, Gesture]>> = {
	ArrowLeft: [-0.1, -0.1, 'pan'],
	ArrowRight: [0.1, 0.1, 'pan'],
	'+': [0.15, -0.15, 'zoom'],
	'-': [-0.2, 0.2, 'zoom'],
};

/** The same by keyboard; Home shows all. */
function keyboardGestures(u: uPlot, onview: OnView): void {
	u.root.tabIndex = 0;
	u.root.addEventListener('keydown', (event) => {
		const { min, max } = u.scales.x!;
		const move = MOVES[event.key];
		if (event.target !== u.root || event.ctrlKey || event.metaKey || event.altKey || !(move || event.key === 'Home') || min == null || max == null) return;
		event.preventDefault();
		if (move) onview([min + move[0] * (max - min), max + move[1] * (max - min)], move[2]);
		else onview(null, 'all');
	});
}

function zoom(u: uPlot, event: WheelEvent, onview: OnView): void {
	event.preventDefault();
	const { min, max } = u.scales.x!;
	if (min == null || max == null) return;
	const factor = Math.exp(Math.max(-60, Math.min(60, event.deltaY)) * 0.004);
	const at = u.posToVal(event.clientX - u.over.getBoundingClientRect().left, 'x');
	onview([at - (at - min) * factor, at + (max - at) * factor], 'zoom');
}

function pan(u: uPlot, begin: MouseEvent, onview: OnView): void {
	const { min, max } = u.scales.x!;
	if (min == null || max == null) return;
	const each = (max - min) / u.over.clientWidth;
	const move = (event: MouseEvent) => {
		const shift = (begin.clientX - event.clientX) * each;
		onview([min + shift, max + shift], 'pan');
	};
	const up = () => {
		removeEventListener('mousemove', move);
		removeEventListener('mouseup', up);
	};
	addEventListener('mousemove', move);
	addEventListener('mouseup', up);
}
