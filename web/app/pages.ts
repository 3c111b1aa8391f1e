/** All pages except the first one: their scripts are loaded when they are opened. */
import { lazy } from './ui/lazy.svelte';

export const pages = {
	live: lazy(() => import('./run/LivePage.svelte')),
	run: lazy(() => import('./run/RunPage.svelte')),
	runs: lazy(() => import('./runs/Runs.svelte')),
	units: lazy(() => import('./units/Units.svelte')),
	workbench: lazy(() => import('./workbench/Workbench.svelte')),
	pick: lazy(() => import('./workbench/RunPicker.svelte')),
	alignment: lazy(() => import('./result/Alignment.svelte')),
	log: lazy(() => import('./settings/LogPage.svelte')),
	settings: lazy(() => import('./settings/Settings.svelte')),
};

/** [ms] In this time the first page sends its own requests. */
const REST_MS = 2000;

/** Preloads the page of a run, so that a run can be watched even if the daemon does not answer at that time. */
export function fetchRunPage(): void {
	setTimeout(() => [pages.live, pages.run].forEach((page) => page.request()), REST_MS);
}
