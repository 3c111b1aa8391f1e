import type uPlot from 'uplot';

/** Positions of the two measuring cursors along x, in any order. */
export type Cursors = readonly [a: number, b: number];
export type OnCursors = (cursors: Cursors) => void;

export function readCursors(text: string | null): Cursors | null {
	const [a = Number.NaN, b = Number.NaN] = text?.split(':').map(Number) ?? [];
	return Number.isFinite(a) && Number.isFinite(b) ? [a, b] : null;
}

export const writeCursors = (cursors: Cursors): string => cursors.map((at) => Number(at.toPrecision(9))).join(':');

/** Initial positions of the cursors: a third of the view from each end. */
export const initialCursors = ([from, to]: readonly [number, number]): Cursors => [from + (to - from) / 3, to - (to - from) / 3];

/** Index of the row nearest to `at`; `null` without rows. */
export function nearestRow(x: ArrayLike<number>, at: number): number | null {
	let best: number | null = null;
	for (let i = 0; i < x.length; i++) {
		if (best === null || Math.abs(x[i]! - at) < Math.abs(x[best]! - at)) best = i;
	}
	return best;
}

export interface CursorLines {
	put: (cursors: Cursors | null) => void;
	/** Called after every painting, because the scale may have changed. */
	place: () => void;
}

/** Two lines over a plot. They are dragged, or moved by the arrow keys: one pixel per key stroke, ten with Shift. */
export function cursorLines(u: uPlot, title: string, moved: OnCursors, reachable: boolean): CursorLines {
	let now: Cursors | null = null;
	const lines = (['A', 'B'] as const).map((name, which) => {
		const line = document.createElement('div');
		line.className = `ruler ruler-${name.toLowerCase()}`;
		line.dataset.name = name;
		line.tabIndex = reachable ? 0 : -1;
		line.setAttribute('role', 'slider');
		line.setAttribute('aria-label', `Cursor ${name} over ${title}`);
		const to = (x: number) => now && moved(which === 0 ? [x, now[1]] : [now[0], x]);
		const at = (event: PointerEvent) => u.posToVal(event.clientX - u.over.getBoundingClientRect().left, 'x');
		line.addEventListener('mousedown', (event) => event.stopPropagation());
		line.addEventListener('pointerdown', (event) => {
			event.stopPropagation();
			line.setPointerCapture(event.pointerId);
		});
		line.addEventListener('pointermove', (event) => line.hasPointerCapture(event.pointerId) && to(at(event)));
		line.addEventListener('keydown', (event) => {
			const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
			const { min, max } = u.scales.x!;
			if (step === undefined || now === null || min == null || max == null) return;
			event.preventDefault();
			event.stopPropagation();
			to(now[which]! + (step * (event.shiftKey ? 10 : 1) * (max - min)) / u.over.clientWidth);
		});
		return line;
	});
	const place = () => {
		const { min, max } = u.scales.x!;
		lines.forEach((line, which) => {
			const x = now?.[which];
			const seen = x !== undefined && min != null && max != null && x >= min && x <= max;
			line.hidden = !seen;
			if (!seen) return;
			line.style.left = `${u.valToPos(x, 'x')}px`;
			line.setAttribute('aria-valuemin', String(min));
			line.setAttribute('aria-valuemax', String(max));
			line.setAttribute('aria-valuenow', String(x));
		});
	};
	return {
		put: (cursors) => {
			if (now === null && cursors) u.over.append(...lines);
			if (cursors === null) lines.forEach((line) => line.remove());
			now = cursors;
			place();
		},
		place,
	};
}
