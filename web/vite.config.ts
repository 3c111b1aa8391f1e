/// <reference types="vitest/config" />
import { svelte } from '@sveltejs/vite-plugin-svelte';
import { minify } from 'terser';
import { defineConfig, type Plugin } from 'vite';

const daemon = process.env.JB_DAEMON ?? 'http://127.0.0.1:8080';

/** What Vite has made small, terser makes two and a half compressed kilobytes smaller. No function here is asked how many arguments it takes. */
const smaller: Plugin = {
	name: 'smaller',
	apply: 'build',
	async generateBundle(_, bundle) {
		for (const chunk of Object.values(bundle)) {
			if (chunk.type === 'chunk') chunk.code = (await minify(chunk.code, { module: true, ecma: 2020, compress: { passes: 2, keep_fargs: false, unsafe: true, unsafe_arrows: true, hoist_funs: true, lhs_constants: false } })).code ?? chunk.code;
		}
	},
};

/** What every chart here is: one x for all curves, linear scales of numbers, no legend but ours, paths of our own. */
const FIXED: [RegExp, string][] = [
	[/\bmode == 1\b/g, 'true'],
	[/\bmode == 2\b/g, 'false'],
	[/[\w.]*\b(distr|xScaleDistr) +== +1\b/g, 'true'],
	[/[\w.]*\b(distr|xScaleDistr) +[=>]= +[2-4]\b|[\w.]*\bdistr == 100/g, 'false'],
	[/\bisTime = .*;/g, 'isTime = false;'],
	[/\bscaleX\.time\b/g, 'false'],
	[/\blegend\.(show|live)\b/g, 'false'],
	[/focus\.prox >= 0|opts\.focus != null|(?<=let _setAlpha = )[^;]+/g, 'false'],
	[/\b(scaleX\.|s)ori == 0/g, 'true'],
	[/\b(scaleX\.|s)ori == 1/g, 'false'],
	[/flags != 0 && bands/g, 'false && bands'],
	// A drag goes along x and chooses; a double click is ours.
	[/\bdragY\b(?! =)|\b(drag\.setScale|cursor\.lock)\b|cursor\._lock(?! =)|(stroke|fill)Path instanceof Map|\brotSrc(?= \?)/g, 'false'],
	[/points\.bbox|drag\.uni/g, 'null'],
	[/events\["setSeries"\][^]*?\n\t};/g, ''],
	[/function dblClick\([^]*?(?=\n\tfunction syncPxRatio)/g, 'const dblClick = null;'],
	[/= (linear|points)\(\) ;/g, '= null;'],
	[/assign\(\{\}, legendOpts, opts\.legend\)/, '{ values: [] }'],
	[/const markers +=.*|\bmarkers\.\w+ +=.*|(?<=\b[as]v) \|\| num\w+/g, ''],
	[/(?<=const showCursor = +)cursor\.show/g, 'true'],
	[/\bcursorOnePt\b(?! =)/g, 'false'],
	// Every column has a value or a gap at each x; points are drawn by paths; no curve is faded, cut by another or in the background; no label is turned.
	[/if \(cursor\.dataIdx == null\) \{[^]*?\n\t\}\n/, 'cursor.dataIdx = (_self, _series, idx) => idx;\n'],
	[/\{\s+let _gaps = s\._paths[^]*?drawPath\(i, true\);\s+\}\s+\}/, ''],
	[/(?<=function drawPath\(si, _points\) \{\s+let s = )_points \? series\[si\]\.points : /, ''],
	[/_points && fillStyle == null|(?<=if \()_points|series\.some\(s => s\._focus\) && [^;]+|ctxAlpha != (s\.alpha|_ctxAlpha)/g, 'false'],
	[/!_points/, 'true'],
	[/if \(bandClip\) \{[^]*?\n\t\t\}\n\t\telse \{/, '{'],
	[/ \|\| bandClip/g, ''],
	[/axis\.rotate\(self, values, i, _space\)|axis\._rotate \* -PI\/180/g, '0'],
	[/if \(opts\.title\) \{[^]*?\n\t\}\n|\(opts\.plugins \|\| \[\]\)[^]*?\n\t\}\);/g, ''],
	// Each scale stands by itself, and what is drawn with the mouse in one plot is not drawn in another.
	[/\b(sc|wsc|scaleOpts)\.from != null|(?<=if \()src != null(?=\) \{\s+let \[xKey)/g, 'false'],
	[/\b(sc|wsc)\.from == null/g, 'true'],
	// Dates, and what only other programs call.
	[/const months = \[[^]*?(?=const onlyWhole)/g, ''],
	[/const NL = [^]*?(?=\/\/ base 2)/g, ''],
	[/const _tzDate [^]*?(?=const activeIdxs)/g, ''],
	[/self\.(setSeries|(add|del)Series|(add|set|del)Band) = \w+;/g, ''],
	[/uPlot\.assign = [^]*?(?=export \{)/g, ''],
];

/** uPlot without what no chart here asks for, as its own builds leave features out: nearly nine kilobytes, compressed. */
const plainUplot: Plugin = {
	name: 'plain-uplot',
	apply: 'build',
	transform(code, id) {
		if (!id.endsWith('uPlot.esm.js')) return;
		for (const [what, by] of FIXED) {
			if (code.search(what) < 0) this.error(`uPlot has changed: ${what} is not in it any more`);
			code = code.replace(what, by);
		}
		return { code, map: null };
	},
};

/** What no page here has, by the file that it is in: nothing awaits while it is drawn or is drawn aside, no effect begins outside of a component or runs ahead, nothing moves on its way in or out or is called off, no form is set back, no state is given another prototype or a property by description, no error has a place of its own, no class is a list, no style is told twice, no choice is of several, no markup comes from a server, nothing is preloaded. */
const NEVER: [string, RegExp, string][] = [
	['reactivity/async.js', /if \(async\.length === 0 && [^]*?(?=\/\*\*\n \* @param \{Blocker)/, 'fn(deriveds);\n}\n'],
	['blocks/boundary.js', /new Boundary\(.*\);/, 'block(() => void branch(() => children(node)), flags);'],
	...['batch', 'deriveds', 'sources'].map((file): [string, RegExp, string] => [`reactivity/${file}.js`, /\b\w+\??\.is_fork(?! =)/g, 'false']),
	['reactivity/batch.js', /increment\(blocking, effect\) \{[^]*?(?=\/\*\*\s+\* @param \{Map<Effect, number>\} dirty_reactions)/, ''],
	['reactivity/batch.js', /settled\(\) \{[^]*?(?=static ensure)/, ''],
	['reactivity/batch.js', /this\.#is_deferred\(\)/g, 'false'],
	['client/runtime.js', /current_batch\?\.is_fork/, 'false'],
	['shared/attributes.js', /return _?clsx\(value\)/, "return value ?? ''"],
	['shared/attributes.js', /if \(value\) \{(?=\s+\/\/ strip)/, 'if (false) {'],
	['bindings/select.js', /\bselect\.multiple\b|entries\.every\(is_selectedcontent_mutation\)|'__defaultValue' in select(?=\) \{)/g, 'false'],
	['reactivity/effects.js', /export function validate_effect\(rune\) \{[^]*?\n\}\n/, 'export function validate_effect() {}\n'],
	...['effects', 'sources'].map((file): [string, RegExp, string] => [`reactivity/${file}.js`, /\((\w+\.f|flags) & EAGER_EFFECT\) !== 0|eager_effects\.size > 0/g, 'false']),
	['reactivity/deriveds.js', /w\.derived_inert\(\);/, ''],
	['reactivity/effects.js', /effect\.nodes && effect\.nodes\.t|(?<=const controller = )effect\.ac/g, 'null'],
	['reactivity/effects.js', /(?<=var remaining = )transitions\.length/, '0'],
	['reactivity/batch.js', /effect\.ac === null/, 'true'],
	...['reactivity/deriveds', 'client/runtime'].map((file): [string, RegExp, string] => [`${file}.js`, /\b(e|reaction|derived)\.ac !== null|(?<=e\.teardown \|\| )e\.ac/g, 'false']),
	['bindings/shared.js', /const prev = [^]*?add_form_reset_listener\(\);/, ''],
	['client/proxy.js', /defineProperty\(_, prop, descriptor\) \{[^]*?\n\t\t\},\n/, ''],
	['client/proxy.js', /,\s+setPrototypeOf\(\) \{[^}]*\}/, ''],
	['dom/hydration.js', /export let (?=hydrating = false)/, 'export const '],
	['dom/hydration.js', /hydrating = value;/, ''],
	['vite/preload-helper.js', /[^]*/, 'export const __vitePreload = (load) => load();'],
];

/** Svelte and Vite without that. */
const plainSvelte: Plugin = {
	name: 'plain-svelte',
	apply: 'build',
	transform(code, id) {
		const here = NEVER.filter(([file]) => id.endsWith(file));
		for (const [file, what, by] of here) {
			if (code.search(what) < 0) this.error(`${file} has changed: ${what} is not in it any more`);
			code = code.replace(what, by);
		}
		return here.length > 0 ? { code, map: null } : undefined;
	},
};

export default defineConfig({
	plugins: [svelte(), plainUplot, plainSvelte, smaller],
	build: { target: 'es2022', cssTarget: ['chrome123', 'firefox121', 'safari17.5'], modulePreload: { polyfill: false }, assetsInlineLimit: 0, cssCodeSplit: false, outDir: 'dist' },
	// `npm run dev` beside a daemon: pages from Vite, everything else from the daemon, which takes only its own origin.
	server: { proxy: { '/api': { target: daemon, ws: true, changeOrigin: true, headers: { origin: daemon } } } },
	test: { include: ['app/**/*.test.ts'] },
});
