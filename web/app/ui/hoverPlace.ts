const GAP_PX = 12;

/** Position [px] in a box of a given size. */
export interface HoverPlace {
	at: readonly [x: number, y: number];
	size: readonly [width: number, height: number];
}

/** Style of a label beside the pointer, on the side with more room: it wraps there and is never cut. */
export function hoverStyle({ at: [x, y], size: [width, height] }: HoverPlace): string {
	const [isLeft, isAbove] = [x > width / 2, y > height / 2];
	const across = isLeft ? `right:${width - x + GAP_PX}px` : `left:${x + GAP_PX}px`;
	const down = isAbove ? `bottom:${height - y + GAP_PX}px` : `top:${y + GAP_PX}px`;
	return `${across};${down};max-width:${Math.max(x, width - x) - GAP_PX}px`;
}
