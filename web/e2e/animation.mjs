// The error falls: a run, its model in the workbench, the missing effect tried and added, as an animation of 20 seconds:
//   cargo run --release -- demo
//   npm run animation -- http://127.0.0.1:8080 [/usr/bin/chromium]
// Writes docs/error-falls.gif of the repository, or $JB_ANIMATION.
import { writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import gifenc from 'gifenc';
import { PNG } from 'pngjs';
import { expect, open, settings, runStory } from './browser.mjs';
import { readVersion, startRun, waitForOtherVersion } from './steps.mjs';

const where = settings('usage: npm run animation -- http://127.0.0.1:8080 [path/to/chromium]');
const file = process.env.JB_ANIMATION ?? fileURLToPath(new URL('../../docs/error-falls.gif', import.meta.url));
/** The page at two thirds of its size. */
const CONTEXT = { viewport: { width: 1440, height: 1080 }, deviceScaleFactor: 2 / 3, reducedMotion: 'reduce' };
/** Time between two pictures of the run, and how long each is shown [ms]. */
const LIVE_EVERY_MS = 100;
const LIVE_FRAME_MS = 300;
const MOST_LIVE_FRAMES = 20;
/** One more index is for pixels that did not change. */
const COLOURS = 255;

/** Pictures of a page with the time for which each is shown. */
class Film {
	frames = [];

	constructor(page) {
		this.page = page;
	}

	async show(duration_ms) {
		const { data, width, height } = PNG.sync.read(await this.page.screenshot());
		this.frames.push({ rgba: data, width, height, duration_ms });
	}

	/** One palette for all pictures; of each only the pixels that changed. */
	encode() {
		const { GIFEncoder, quantize, applyPalette } = gifenc;
		const palette = [...quantize(Buffer.concat(this.frames.map(({ rgba }) => rgba)), COLOURS), [0, 0, 0]];
		const gif = GIFEncoder();
		let last = null;
		for (const { rgba, width, height, duration_ms } of this.frames) {
			const index = applyPalette(rgba, palette.slice(0, -1));
			const changed = last === null ? index : index.map((colour, i) => (colour === last[i] ? COLOURS : colour));
			gif.writeFrame(changed, width, height, { palette, delay: duration_ms, transparent: last !== null, transparentIndex: COLOURS, dispose: 1 });
			last = index;
		}
		gif.finish();
		return gif.bytes();
	}
}

await runStory(file, async () => {
	const { browser, page, faults } = await open(where, CONTEXT);
	const film = new Film(page);
	await startRun(page, where.base);
	const toResult = page.getByRole('button', { name: 'Show the result' });
	for (let i = 0; i < MOST_LIVE_FRAMES && !(await toResult.isVisible()); i++) {
		await page.waitForTimeout(LIVE_EVERY_MS);
		await film.show(LIVE_FRAME_MS);
	}
	await toResult.click({ timeout: 180_000 });
	await page.getByRole('link', { name: 'Open in the workbench' }).click();
	const first = await readVersion(page);
	expect(first.verdict === 'missing_effect', `nothing is missing, the verdict is ${first.verdict}: hide an effect (jointbench demo --effect load_linear)`);
	await film.show(4000);
	await page.locator('a.region').first().click();
	await page.locator('a.region[aria-current=true]').waitFor();
	await film.show(2500);
	await page.locator('article[data-effect]').first().getByRole('button', { name: 'Try' }).click();
	await page.locator('[data-beside=try] figure').first().waitFor();
	await film.show(3500);
	await page.keyboard.press('x');
	await page.locator('[data-beside]').waitFor({ state: 'detached' });
	const second = await waitForOtherVersion(page, () => page.keyboard.press('a'));
	expect(second.held < first.held, `the error should fall, but went from ${first.held} to ${second.held}`);
	await film.show(6000);
	expect(faults.length === 0, `the page is not clean:\n  ${faults.join('\n  ')}`);
	await browser.close();
	writeFileSync(file, film.encode());
	console.log(`${film.frames.length} pictures, ${film.frames.reduce((sum, one) => sum + one.duration_ms, 0) / 1000} s`);
});
