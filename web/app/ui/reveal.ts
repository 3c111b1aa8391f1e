import { tick } from 'svelte';

const calm = matchMedia('(prefers-reduced-motion: reduce)');

/** Brings what a press has made into view, where it is not there already, and takes the focus to it, so that it is read out. */
export async function reveal(id: string): Promise<void> {
	await tick();
	const node = document.getElementById(id);
	if (!node) return;
	node.focus({ preventScroll: true });
	const { top } = node.getBoundingClientRect();
	if (top < 0 || top > innerHeight / 2) node.scrollIntoView({ behavior: calm.matches ? 'auto' : 'smooth' });
}
