/** The pages beside the first: their scripts come when they are opened. */
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

/** A run is watched also where the daemon does not answer when its page is opened. */
export function fetchRunPage(): void {
	setTimeout(() => [pages.live, pages.run].forEach((page) => page.want()), REST_MS);
}
