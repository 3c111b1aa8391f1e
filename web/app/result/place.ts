const KEPT = 'jointbench.place';
const heights = (): Record<string, number> => JSON.parse(localStorage.getItem(KEPT) ?? '{}') as Record<string, number>;
/** The same thing is as high again in a window that is about as wide. */
const keyOf = (what: string) => `${what} ${Math.round(innerWidth / 60)}`;

/** Height [px] that a card had when it was last drawn. */
export const placeOf = (what: string): number | undefined => heights()[keyOf(what)];

export function keepPlace(what: string, height_px: number): void {
	localStorage.setItem(KEPT, JSON.stringify({ ...heights(), [keyOf(what)]: Math.round(height_px) }));
}
