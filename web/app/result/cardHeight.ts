const STORAGE_KEY = 'jointbench.place';
const heights = (): Record<string, number> => JSON.parse(localStorage.getItem(STORAGE_KEY) ?? '{}') as Record<string, number>;
/** The same content has the same height in a window of similar width. */
const keyOf = (what: string) => `${what} ${Math.round(innerWidth / 60)}`;

/** Height [px] of a card when it was last drawn. */
export const cardHeight = (what: string): number | undefined => heights()[keyOf(what)];

export function saveCardHeight(what: string, height_px: number): void {
	localStorage.setItem(STORAGE_KEY, JSON.stringify({ ...heights(), [keyOf(what)]: Math.round(height_px) }));
}
