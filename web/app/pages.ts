/** The pages that nobody sees first: their scripts come when they are opened, or when the first page has nothing more to do. */
import { later } from './ui/later.svelte';

export const pages = {
	live: later(() => import('./run/Live.svelte')),
	run: later(() => import('./run/RunPage.svelte')),
	runs: later(() => import('./runs/Runs.svelte')),
	workbench: later(() => import('./workbench/Workbench.svelte')),
	pick: later(() => import('./workbench/Pick.svelte')),
	alignment: later(() => import('./result/Alignment.svelte')),
	log: later(() => import('./settings/Log.svelte')),
	settings: later(() => import('./settings/Settings.svelte')),
};

/** [ms] The first page asks the daemon for what it shows meanwhile. */
const REST_MS = 2000;

/** So that another page opens at once, and also while the daemon does not answer. */
export function fetchPages(): void {
	setTimeout(() => Object.values(pages).forEach((page) => page.want()), REST_MS);
}
