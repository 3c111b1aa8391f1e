import { tick } from 'svelte';

/** Brings what a press has made into view, where it is not there already, and takes the focus to it, so that it is read out. At once: a gliding page loses its aim where more is drawn meanwhile. */
export async function reveal(id: string): Promise<void> {
	await tick();
	const node = document.getElementById(id);
	if (!node) return;
	node.focus({ preventScroll: true });
	const { top } = node.getBoundingClientRect();
	if (top < 0 || top > innerHeight / 2) node.scrollIntoView();
}
