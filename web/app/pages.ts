/** All pages except the first one: their scripts are loaded when they are opened. */
import { later } from './ui/lazy.svelte';

export const pages = {
	live: later(() => import('./run/LivePage.svelte')),
	run: later(() => import('./run/RunPage.svelte')),
	runs: later(() => import('./runs/Runs.svelte')),
	workbench: later(() => import('./workbench/Workbench.svelte')),
	pick: later(() => import('./workbench/RunPicker.svelte')),
	alignment: later(() => import('./result/Alignment.svelte')),
	log: later(() => import('./settings/LogPage.svelte')),
	settings: later(() => import('./settings/Settings.svelte')),
};

/** [ms] In this time the first page sends its own requests. */
const REST_MS = 2000;

/** Preloads the page of a run, so that a run can be watched even if the daemon does not answer at that time. */
export function fetchRunPage(): void {
	setTimeout(() => [pages.live, pages.run].forEach((page) => page.want()), REST_MS);
}
