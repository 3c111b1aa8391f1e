// States of pages that a short story reaches: an archived run, a chart without the chosen quantity, entries that left the queue.
//   node web/e2e/states.mjs http://127.0.0.1:8080 [/usr/bin/chromium]
// The daemon has one bench, and an archive with samples. With $JB_SCREENS, saves images of the pages there.
import { audit } from './audit.mjs';
import { expect, open, settings, runStory, TIMEOUT_MS } from './browser.mjs';
import { makeRun } from './steps.mjs';

const where = settings('usage: node web/e2e/states.mjs http://127.0.0.1:8080 [path/to/chromium]');
const LOOK_MS = 200;

async function shoot(page, name) {
	if (!process.env.JB_SCREENS) return;
	for (const [width, height] of [[1440, 900], [420, 900]]) {
		await page.setViewportSize({ width, height });
		for (const colorScheme of ['light', 'dark']) {
			await page.emulateMedia({ colorScheme, reducedMotion: 'reduce' });
			await page.waitForTimeout(400);
			await page.screenshot({ path: `${process.env.JB_SCREENS}/${name}-${width}-${colorScheme}.png`, fullPage: true });
		}
	}
	await page.setViewportSize({ width: 1440, height: 900 });
	await page.emulateMedia({ colorScheme: 'light', reducedMotion: null });
}

const rest = async (path, method = 'GET', body = undefined) => {
	const answer = await fetch(`${where.base}/api/v1${path}`, { method, headers: { 'content-type': 'application/json' }, body: body && JSON.stringify(body) });
	return { ok: answer.ok, json: await answer.json() };
};

/** Waits until the answer to a request is as wanted. */
async function until(path, wanted, what) {
	const end = Date.now() + TIMEOUT_MS;
	while (Date.now() < end) {
		if (wanted((await rest(path)).json)) return;
		await new Promise((ok) => setTimeout(ok, LOOK_MS));
	}
	expect(false, what);
}

/** A run whose samples are only in the archive offers nothing that needs them, and says why. */
async function showArchivedRun(page) {
	const run = await makeRun(where.base, 'friction', { load_levels: 1 });
	await page.goto(`${where.base}/runs/${run}`);
	await page.getByRole('link', { name: 'CSV', exact: true }).waitFor({ timeout: TIMEOUT_MS });
	await until('/archive', ({ owed }) => owed === 0, 'the run is not archived');
	const { ok, json } = await rest(`/runs/${run}/samples`, 'DELETE');
	expect(ok, `the samples are not removed: ${json.detail}`);
	await page.reload();
	await page.getByText('The samples are only in the archive').waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'the page of an archived run does not say where its samples are'));
	for (const name of ['CSV', 'Parquet', 'Open in the workbench', 'Derived channel', 'X–Y', 'Spectrum']) {
		const button = page.getByRole('button', { name, exact: true });
		expect(await button.isDisabled(), `${name} of an archived run is not disabled`);
	}
	await page.keyboard.press('w');
	expect(new URL(page.url()).pathname === `/runs/${run}`, 'the key w opens the workbench of an archived run');
	await audit(page, 'an archived run');
	await shoot(page, 'archived');
}

/** A quantity that the procedure does not have is no failure: the chart says what to choose. */
async function showEmptyChart(page) {
	const [{ name: bench }] = (await rest('/bench')).json;
	const { json: run } = await rest('/runs', 'POST', { bench, procedure: 'friction', parameters: { load_levels: 1 }, unit: { serial: 'SN1' } });
	await until(`/runs/${run.id}`, ({ verdict }) => verdict, 'the run of a unit has no verdict');
	await page.goto(`${where.base}/units?quantity=torsional_stiffness`);
	await page.getByText('has the quantity torsional_stiffness').waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'a chart without the chosen quantity gives no reason'));
	expect((await page.getByRole('alert').count()) === 0, 'a chart without the chosen quantity is shown as a failure');
	await audit(page, 'a chart without the chosen quantity');
	await shoot(page, 'chart');
	await page.getByLabel('quantity').selectOption('tau_c');
	await page.locator('[data-figure]').first().waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'another quantity draws no chart'));
}

await runStory('states', async () => {
	const { browser, page, faults } = await open(where);
	await showEmptyChart(page);
	await showArchivedRun(page);
	expect(faults.length === 0, faults.join('\n'));
	await browser.close();
});
