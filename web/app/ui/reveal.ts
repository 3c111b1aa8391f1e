import { tick } from 'svelte';

/**
 * Scrolls the result of an action into view, if necessary, and moves the focus to it, so that a screen reader reads it.
 * Scrolls without animation, because content that loads meanwhile would change the target.
 */
export async function reveal(id: string): Promise<void> {
	await tick();
	const node = document.getElementById(id);
	if (!node) return;
	node.focus({ preventScroll: true });
	const { top } = node.getBoundingClientRect();
	if (top < 0 || top > innerHeight / 2) node.scrollIntoView();
}
