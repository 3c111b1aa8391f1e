/// <reference types="vitest/config" />
import { svelte } from '@sveltejs/vite-plugin-svelte';
import { minify } from 'terser';
import { defineConfig, type Plugin } from 'vite';

const daemon = process.env.JB_DAEMON ?? 'http://127.0.0.1:8080';

/** What Vite has made small, terser makes two and a half compressed kilobytes smaller. */
const smaller: Plugin = {
	name: 'smaller',
	apply: 'build',
	async generateBundle(_, bundle) {
		for (const chunk of Object.values(bundle)) {
			// A second time finds half a kilobyte more.
			for (let time = 0; time < 2 && chunk.type === 'chunk'; time++) chunk.code = (await minify(chunk.code, { module: true, ecma: 2020, compress: { passes: 2, unsafe_arrows: true } })).code ?? chunk.code;
		}
	},
};

export default defineConfig({
	plugins: [svelte(), smaller],
	build: { target: 'es2022', modulePreload: false, assetsInlineLimit: 0, cssCodeSplit: false, outDir: 'dist' },
	// `npm run dev` beside a daemon: pages from Vite, everything else from the daemon, which takes only its own origin.
	server: { proxy: { '/api': { target: daemon, ws: true, changeOrigin: true, headers: { origin: daemon } } } },
	test: { include: ['app/**/*.test.ts'] },
});
