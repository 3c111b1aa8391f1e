/// <reference types="vitest/config" />
import { svelte } from '@sveltejs/vite-plugin-svelte';
import { defineConfig } from 'vite';

const daemon = process.env.JB_DAEMON ?? 'http://127.0.0.1:8080';

export default defineConfig({
	plugins: [svelte()],
	build: { target: 'es2022', modulePreload: false, assetsInlineLimit: 0, cssCodeSplit: false, outDir: 'dist' },
	// `npm run dev` beside a daemon: pages from Vite, everything else from the daemon, which takes only its own origin.
	server: { proxy: { '/api': { target: daemon, ws: true, changeOrigin: true, headers: { origin: daemon } } } },
	test: { include: ['app/**/*.test.ts'] },
});
