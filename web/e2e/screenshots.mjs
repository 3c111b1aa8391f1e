// Every screen, light and dark, for the documentation:
//   node web/e2e/screenshots.mjs http://127.0.0.1:8080 [/usr/bin/chromium]
// Writes into docs/screens of the repository, or into $JB_SCREENS.
import { mkdirSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { expect, open, settings, runStory } from './browser.mjs';
import { chooseForeign, FOREIGN } from './files.mjs';
import { WITHOUT_LOAD, startAndStopAutopilot, makeRun, measureNext, readVersion, startRun, waitForOtherVersion, WITHOUT_REPEATS, watchRun } from './steps.mjs';

const where = settings('usage: node web/e2e/screenshots.mjs http://127.0.0.1:8080 [path/to/chromium]');
const folder = process.env.JB_SCREENS ?? fileURLToPath(new URL('../../docs/screens', import.meta.url));
mkdirSync(folder, { recursive: true });

const NARROW = { width: 768, height: 1024 };
const WIDE = { width: 1440, height: 900 };
/** Tall enough for the residual map. */
const TALL = { width: 1440, height: 1240 };

/** Short runs with different kinds of results. */
const GALLERY = {
	demagnetise: {},
	brake_speed_independence: {},
	brake_hysteresis: { levels: 8, loops: 1, random_turns: 8 },
	stiffness: { load_levels: 4 },
	compensation: {},
	encoder_linearity: {},
	encoder_alignment: { halvings: 2, map_positions: 3 },
	puma_friction: {},
};

async function shoot(page, name) {
	for (const theme of ['light', 'dark']) {
		await page.emulateMedia({ colorScheme: theme, reducedMotion: 'reduce' });
		await page.waitForTimeout(350);
		await page.screenshot({ path: `${folder}/${name}-${theme}.png` });
	}
}

await runStory(`screens in ${folder}`, async () => {
	const { browser, page, faults } = await open(where);
	await page.goto(where.base);
	await page.waitForFunction(() => document.querySelector('.go .primary:enabled'), null, { timeout: 20_000 });
	await shoot(page, 'bench');

	const run = await startRun(page, where.base);
	await page.locator('.uplot').first().waitFor();
	await page.waitForTimeout(2500);
	await shoot(page, 'live');
	const toWorkbench = await watchRun(page);
	await shoot(page, 'run');

	await page.locator('[data-result] [data-figure]').first().waitFor({ timeout: 60_000 });
	await shoot(page, 'result-friction');
	await page.setViewportSize(NARROW);
	await shoot(page, 'result-narrow');
	await page.setViewportSize(WIDE);
	await page.locator('header:has(h1)').last().scrollIntoViewIfNeeded();

	await toWorkbench.click();
	const first = await readVersion(page);
	await page.setViewportSize(TALL);
	await shoot(page, 'workbench-missing');
	await page.setViewportSize(WIDE);
	if (first.verdict === 'missing_effect') {
		await page.locator('a.region').first().click();
		await shoot(page, 'workbench-region');
		await waitForOtherVersion(page, () => page.keyboard.press('a'));
		await shoot(page, 'workbench-added');
	}
	await page.setViewportSize(NARROW);
	await shoot(page, 'workbench-narrow');
	await page.setViewportSize(WIDE);

	await startRun(page, where.base, WITHOUT_LOAD);
	await (await watchRun(page)).click();
	await readVersion(page);
	await shoot(page, 'workbench-next');
	await measureNext(page);
	await page.getByRole('button', { name: 'Own formula' }).click();
	const form = page.getByRole('form', { name: 'Own formula' });
	await form.getByLabel('formula', { exact: true }).fill('tau = a * tanh(velocity / w0) * abs(load');
	await form.getByLabel('name', { exact: true }).fill('Load drag');
	await form.locator('mark').waitFor();
	await form.scrollIntoViewIfNeeded();
	await shoot(page, 'workbench-formula');
	await startAndStopAutopilot(page, `${where.base}/workbench`);
	await shoot(page, 'autopilot');

	await page.goto(`${where.base}/runs`);
	await page.getByRole('link', { name: `#${run}` }).waitFor();
	await shoot(page, 'runs');

	for (const [procedure, parameters] of Object.entries(GALLERY)) {
		const made = await makeRun(where.base, procedure, parameters);
		if (made === null) continue;
		await page.goto(`${where.base}/runs/${made}`);
		await page.locator('[data-result] [data-figure]').first().waitFor({ timeout: 60_000 });
		await shoot(page, `result-${procedure}`);
	}
	const bare = await makeRun(where.base, 'strokes', WITHOUT_REPEATS);
	if (bare !== null) {
		await page.goto(`${where.base}/workbench/${bare}`);
		expect((await readVersion(page)).verdict === 'undecided', 'a run without repeats should leave the diagnosis undecided');
		await shoot(page, 'workbench-undecided');
	}
	await page.goto(`${where.base}/runs/${run}`);
	await page.getByRole('button', { name: 'Measure' }).click();
	await page.locator('[data-measured]').first().waitFor();
	await page.locator('.uplot').first().scrollIntoViewIfNeeded();
	await shoot(page, 'run-measured');

	await page.goto(`${where.base}/runs?compare=${run},${run + 1}`);
	await page.getByRole('heading', { name: 'Compare 2 runs' }).waitFor();
	await page.locator('.uplot').first().waitFor();
	await shoot(page, 'compare');
	await chooseForeign(page, where.base, FOREIGN);
	await shoot(page, 'import');
	for (const path of ['log', 'settings']) {
		await page.goto(`${where.base}/${path}`);
		await page.getByRole('heading', { level: 1 }).first().waitFor({ state: 'attached' });
		await shoot(page, path);
	}
	await page.goto(where.base);
	await page.waitForFunction(() => document.querySelector('.go .primary:enabled'), null, { timeout: 20_000 });
	await page.keyboard.press('?');
	await page.getByRole('dialog').waitFor();
	await shoot(page, 'help');
	expect(faults.length === 0, `the page is not clean:\n  ${faults.join('\n  ')}`);
	await browser.close();
});
