const GAP_PX = 12;

/** Position [px] in a box of a given size. */
export interface HoverPlace {
	at: readonly [x: number, y: number];
	size: readonly [width: number, height: number];
}

/** Style of a label at the pointer, on the side with more room: it wraps there and is never cut. */
export function hoverStyle({ at: [x, y], size: [width, height] }: HoverPlace): string {
	const [isLeft, isAbove] = [x > width / 2, y > height / 2];
	const [across, right] = isLeft ? ['right', x - width - GAP_PX] : ['left', x + GAP_PX];
	const [down, below] = isAbove ? ['bottom', y - height - GAP_PX] : ['top', y + GAP_PX];
	// A translation follows the pointer without a new layout.
	return `${across}:0;${down}:0;translate:${right}px ${below}px;max-width:${Math.max(x, width - x) - GAP_PX}px`;
}
