import { readdirSync } from 'node:fs';
import { vitePreprocess } from '@sveltejs/vite-plugin-svelte';

const slashes = (path) => path.replaceAll('\\', '/');
const components = readdirSync(new URL('app', import.meta.url), { recursive: true })
	.filter((file) => file.endsWith('.svelte'))
	.map((file) => `app/${slashes(file)}`)
	.sort();
/** The place of a component among all of them: two letters instead of a hash are more than half a kilobyte of the bundle. */
const placeOf = (filename) => components.findIndex((file) => slashes(filename).endsWith(file)).toString(36);

export default {
	preprocess: vitePreprocess(),
	compilerOptions: { runes: true, discloseVersion: false, cssHash: ({ filename }) => `s${placeOf(filename)}` },
};
