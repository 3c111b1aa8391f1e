import type uPlot from 'uplot';
import type { OnView } from './gestures';

/**
 * Touch gestures on a plot (uPlot issue 13): one finger along x selects a range, two fingers zoom and move. Vertical
 * movement scrolls the page.
 */
export function touchGestures(u: uPlot, onview: OnView): void {
	const { over } = u;
	const fingers = new Map<number, number>();
	let pinch: { span: number; at: number; min: number; max: number } | null = null;
	let from: number | null = null;
	over.style.touchAction = 'pan-y';
	const place = (event: PointerEvent) => Math.max(0, Math.min(over.clientWidth, event.clientX - over.getBoundingClientRect().left));
	const select = (a: number, b: number) =>
		u.setSelect({ left: Math.min(a, b), width: Math.abs(b - a), top: 0, height: over.clientHeight }, false);

	over.addEventListener('pointerdown', (event) => {
		if (event.pointerType === 'mouse') return;
		fingers.set(event.pointerId, place(event));
		const [a, b] = [...fingers.values()];
		const { min, max } = u.scales.x!;
		from = fingers.size === 1 ? a! : null;
		pinch = null;
		if (a === undefined || b === undefined || min == null || max == null) return;
		select(0, 0);
		pinch = { span: Math.max(20, Math.abs(a - b)), at: (a + b) / 2, min, max };
	});
	over.addEventListener('pointermove', (event) => {
		if (!fingers.has(event.pointerId)) return;
		fingers.set(event.pointerId, place(event));
		const [a, b] = [...fingers.values()];
		if (pinch && a !== undefined && b !== undefined) {
			const width = over.clientWidth;
			const scale = (pinch.max - pinch.min) * (pinch.span / Math.max(20, Math.abs(a - b)));
			const anchorValue = pinch.min + ((pinch.max - pinch.min) * pinch.at) / width;
			const begin = anchorValue - (scale * (a + b)) / 2 / width;
			onview([begin, begin + scale], 'zoom');
		} else if (from !== null) select(from, a!);
	});
	const lift = (event: PointerEvent) => {
		if (!fingers.delete(event.pointerId)) return;
		const to = place(event);
		if (event.type === 'pointerup' && !pinch && from !== null && Math.abs(to - from) > 12) {
			onview([u.posToVal(Math.min(from, to), 'x'), u.posToVal(Math.max(from, to), 'x')], 'box');
		}
		select(0, 0);
		from = null;
		if (fingers.size === 0) pinch = null;
	};
	over.addEventListener('pointerup', lift);
	over.addEventListener('pointercancel', lift);
}
