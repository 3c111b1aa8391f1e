// Checks of pages besides the main path of the walk.
import { readFileSync } from 'node:fs';
import { audit } from './audit.mjs';
import { expect, TIMEOUT_MS } from './browser.mjs';
import { dropFiles } from './files.mjs';
import { layoutShiftOf, makeRun, readVersion } from './steps.mjs';

/** Expects that the result of an action is visible and has the focus. */
export async function expectInView(locator, what) {
	await locator.waitFor({ timeout: TIMEOUT_MS });
	const seen = () => locator.evaluate((node) => {
		const { top } = node.getBoundingClientRect();
		return { onScreen: top >= 0 && top < innerHeight * 0.7, focused: document.activeElement === node };
	});
	const until = Date.now() + TIMEOUT_MS;
	let found = await seen();
	while (!(found.onScreen && found.focused) && Date.now() < until) {
		await new Promise((ok) => setTimeout(ok, 100));
		found = await seen();
	}
	expect(found.onScreen && found.focused, `${what} is not brought into view: ${JSON.stringify(found)}`);
}

/** Zooms a plot of an active run with the wheel. The plot must continue to follow, with a shorter range. Needs a paced bench, so that the run lasts. */
export async function zoomWhileFollowing(page, base) {
	const post = async (path, body) => (await fetch(`${base}/api/v1${path}`, { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(body) })).json();
	const benches = await (await fetch(`${base}/api/v1/bench`)).json();
	const waits = await Promise.all(benches.map(async ({ name }) => ({ name, ...(await post('/procedures/friction/preview', { bench: name })) })));
	const bench = waits.find(({ wait_s }) => wait_s > 20)?.name;
	if (!bench) return console.log('no bench keeps a pace: zooming a run that is on is left out');
	// The dwells are long, so that the run does not end early on a slow machine. The travel stays within the range of the link.
	const { id } = await post('/runs', { bench, procedure: 'friction', parameters: { dwell_s: 4 } });
	await page.goto(`${base}/runs/${id}`);
	const plot = page.locator('main figure .u-over').first();
	await plot.waitFor({ timeout: TIMEOUT_MS });
	await audit(page, 'the run that is on');
	await plot.hover();
	await page.mouse.wheel(0, -300);
	await page.waitForURL(/view=follow:[\d.]+/, { timeout: TIMEOUT_MS }).catch(() => expect(false, `a zoom ends the following: ${page.url()}`));
	expect(Number(/view=follow:([\d.]+)/.exec(page.url())[1]) < 10, `the wheel does not shorten the stretch: ${page.url()}`);
	const picture = () => page.locator('main figure canvas').first().evaluate((canvas) => canvas.toDataURL());
	const before = await picture();
	const until = Date.now() + TIMEOUT_MS;
	while ((await picture()) === before && Date.now() < until) await page.waitForTimeout(100);
	expect((await picture()) !== before, 'the plot stands still after a zoom, although the run goes on');
	await page.keyboard.press('Space');
	await page.waitForURL(/view=-?[\d.]+:[\d.]+/, { timeout: TIMEOUT_MS }).catch(() => expect(false, `Space does not freeze the plots: ${page.url()}`));
	await page.keyboard.press('Space');
	await page.waitForURL(/view=follow:/, { timeout: TIMEOUT_MS }).catch(() => expect(false, `Space does not go on: ${page.url()}`));
	const focused = await page.evaluateHandle(() => document.activeElement);
	await page.keyboard.press('n');
	await page.keyboard.type('walked by');
	await page.keyboard.press('Enter');
	// The note appears after it is stored durably, which takes as long as the disk needs.
	const notes = page.getByRole('list', { name: 'Notes' });
	await notes.locator('li', { hasText: 'walked by' }).waitFor({ timeout: TIMEOUT_MS }).catch(async () => expect(false, `Enter does not keep a note: ${await page.getByRole('form', { name: 'Note' }).locator('xpath=../..').innerText()}`));
	// The focus returns to the former element, or to the notes if there was none.
	const returned = (from) => document.activeElement === (from === document.body ? document.querySelector('ol[aria-label=Notes]') : from);
	await page.waitForFunction(returned, focused, { timeout: TIMEOUT_MS }).catch(() => expect(false, 'Enter in a note loses the focus'));
	await post(`/runs/${id}/notes`, { at_s: 1, text: 'heard by another client' });
	for (const list of [notes, page.getByRole('list', { name: 'Journal' })]) {
		await list.getByText('heard by another client').waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'a note of another client does not appear on the open run page'));
	}
	const box = await plot.boundingBox();
	const followed = page.url();
	await page.mouse.move(box.x + box.width * 0.3, box.y + 50);
	await page.mouse.down();
	await page.mouse.move(box.x + box.width * 0.7, box.y + 50, { steps: 4 });
	await page.mouse.up();
	await page.waitForURL(/view=-?[\d.]+:/, { timeout: TIMEOUT_MS }).catch(() => expect(false, 'a drag chooses no stretch'));
	await plot.dblclick();
	await page.waitForURL(followed, { timeout: TIMEOUT_MS }).catch(() => expect(false, `one double click does not go back to what was followed: ${page.url()}`));
	await page.keyboard.press('0');
	await page.waitForURL(/view=all/, { timeout: TIMEOUT_MS });
	const all = await picture();
	await page.waitForFunction((before) => document.querySelector('main figure canvas').toDataURL() !== before, all, { timeout: TIMEOUT_MS }).catch(() => expect(false, 'all of a run that is on does not grow'));
	await page.goto(`${base}/?bench=${bench}`);
	const health = page.locator('section', { has: page.getByRole('heading', { name: 'Channel health' }) });
	await health.locator('tbody tr', { hasText: 'motor velocity' }).waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'the channels of a run that is on are not told'));
	await page.goto(`${base}/runs/${id}`);
	for (const name of [/^Abort/, 'Yes, abort']) await page.getByRole('button', { name }).press('Enter');
	await page.locator('#end-of-run:focus').waitFor({ timeout: 30_000 }).catch(() => expect(false, 'the end of a run that is aborted loses the focus'));
	await page.keyboard.press('Enter');
	await page.locator('h1:focus').waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'the opened result has no focus'));
}

/** Zooms a plot and selects a cell of the residual map by keyboard. Returns the text of the cell. */
export async function byKeyboard(page) {
	const plot = page.locator('section', { has: page.getByRole('heading', { name: 'Measured against model' }) }).locator('.uplot').first();
	await plot.focus();
	await page.keyboard.press('+');
	await page.waitForURL(/zoom=/, { timeout: TIMEOUT_MS }).catch(() => expect(false, 'a plot cannot be zoomed by keyboard'));
	await page.keyboard.press('ArrowRight');
	await page.keyboard.press('Home');
	await page.waitForURL((url) => !url.searchParams.has('zoom'), { timeout: TIMEOUT_MS }).catch(() => expect(false, 'Home does not show all'));
	const map = page.getByRole('application');
	await map.focus();
	for (const key of ['ArrowRight', 'ArrowRight', 'ArrowUp', 'Shift+ArrowUp']) await page.keyboard.press(key);
	const text = await page.locator('output', { hasText: 'n = ' }).or(page.locator('output', { hasText: 'not measured' })).first().innerText();
	await page.keyboard.press('Enter');
	await page.waitForURL((url) => url.searchParams.get('region')?.split(',').length === 2, { timeout: TIMEOUT_MS }).catch(() => expect(false, 'no cell can be chosen by keyboard'));
	await page.keyboard.press('c');
	return text;
}

/** Opens the address of an unknown version. Returns the message that names the displayed version. */
export async function openUnknownVersion(page, base, run) {
	await page.goto(`${base}/workbench/${run}?model=987654`);
	const text = page.getByText(`Run #${run} has no model 987654`);
	await text.waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'nobody says that a version of the address is not there'));
	return text.innerText();
}

/** Saves the run as a table and opens its report. */
export async function exportRun(page, base, run) {
	await page.goto(`${base}/runs/${run}`);
	const [file] = await Promise.all([page.waitForEvent('download'), page.getByRole('link', { name: 'CSV', exact: true }).click()]);
	const table = readFileSync(await file.path(), 'utf8');
	const [report] = await Promise.all([page.waitForEvent('popup'), page.getByRole('link', { name: 'Report' }).click()]);
	await report.locator('svg').first().waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'the report has no figure'));
	const text = await report.locator('body').innerText();
	await report.close();
	return { name: file.suggestedFilename(), table, report: text };
}

/** Saves the residual map as a file. Returns its name and its first bytes. */
export async function exportMap(page) {
	await page.getByLabel('Menu of Residual map').click();
	const [file] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: 'Parquet' }).click()]);
	return { name: file.suggestedFilename(), begins: readFileSync(await file.path(), 'latin1').slice(0, 4) };
}

/** Loads earlier entries of the log until the first run is displayed. */
export async function showEarlier(page, base) {
	await page.goto(`${base}/log`);
	await page.locator('main tbody tr').first().waitFor({ timeout: TIMEOUT_MS });
	const first = page.getByRole('cell', { name: '#1', exact: true }).first();
	expect(!(await first.isVisible()), 'the log begins with more than the newest runs');
	for (let pages = 0; pages < 40 && !(await first.isVisible()); pages++) {
		await page.getByRole('button', { name: 'Show earlier' }).click({ timeout: TIMEOUT_MS });
		await first.waitFor({ timeout: 1000 }).catch(() => {});
	}
	expect(await first.isVisible(), 'the log does not go back to the first run');
	await audit(page, 'the log of earlier runs');
}

/** Imports the export of a run again, the same table with its current in mA, and an empty file. Returns the text of the page. */
export async function reimportRun(page, base, run, table) {
	const meta = await (await fetch(`${base}/api/v1/runs/${run}/meta`)).text();
	const [names, ...rows] = table.trim().split('\n').map((line) => line.split(','));
	const current = names.indexOf('motor_current_a');
	const milli = [names, ...rows.map((row) => row.with?.(current, 1000 * row[current]) ?? row)].map((row) => row.join(',')).join('\n');
	await dropFiles(page, base, [['copy.csv', table], ['milli.csv', milli], ['none.csv', ''], ['meta.json', meta]]);
	const card = page.getByRole('region', { name: 'Import' });
	await card.getByText('the file is empty').waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'an empty file is not refused'));
	const text = await card.innerText();
	await card.getByRole('link', { name: 'open in the workbench' }).nth(1).click();
	return { text, ...(await readVersion(page)) };
}

/** Returns the dashes of the lines of a comparison, in its legend and as painted. */
export async function dashesOf(page, address) {
	await page.addInitScript(() => {
		window.painted = new Set();
		const { setLineDash } = CanvasRenderingContext2D.prototype;
		CanvasRenderingContext2D.prototype.setLineDash = function (dash) {
			window.painted.add(dash.join(' '));
			setLineDash.call(this, dash);
		};
	});
	await page.goto(address);
	const plot = page.locator('figure:has(.uplot)').first();
	await plot.waitFor({ timeout: TIMEOUT_MS });
	await page.locator('[data-figure=difference]').waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'the difference of the runs is not drawn'));
	const legend = await plot.locator('figcaption line').evaluateAll((lines) => lines.map((line) => line.getAttribute('stroke-dasharray') ?? ''));
	const ratio = await page.evaluate(() => devicePixelRatio);
	const painted = await page.evaluate(() => [...window.painted]);
	const inks = (figure) => figure.locator('[stroke^="var(--oi"]').evaluateAll((drawn) => [...new Set(drawn.map((one) => one.getAttribute('stroke')))]);
	const [above, below] = [await inks(plot), await inks(page.locator('[data-figure=difference]'))];
	expect(below.join() === above.slice(1).join(), `the difference is drawn in ${below.join()}, its runs above in ${above.join()}`);
	return { jumps: await layoutShiftOf(page), legend, missing: legend.filter((dash) => !painted.includes(dash.split(' ').map((n) => (n ? n * ratio : '')).join(' '))) };
}

/** Displays a list of ten thousand runs, with answers in place of the daemon's. Returns the number of rows and the time of a jump to the last row. */
export async function openManyRuns(page, base) {
	const MANY = 10_000;
	const [one] = (await (await fetch(`${base}/api/v1/runs?limit=1`)).json()).runs;
	await page.route('**/api/v1/runs?*', (route) => {
		const query = new URL(route.request().url()).searchParams;
		const [limit, offset] = [Number(query.get('limit')), Number(query.get('offset') ?? 0)];
		const runs = query.get('search') ? [] : Array.from({ length: Math.min(limit, MANY - offset) }, (_, i) => ({ ...one, id: MANY - offset - i, tags: [] }));
		return route.fulfill({ json: { total: query.get('search') ? 0 : MANY, runs } });
	});
	await page.goto(`${base}/runs`);
	await page.getByRole('link', { name: `#${MANY}`, exact: true }).waitFor({ timeout: TIMEOUT_MS });
	const rows = await page.locator('main tbody tr').count();
	const begun = Date.now();
	await page.locator('main tbody tr').first().evaluate((row) => {
		let box = row.parentElement;
		while (!/auto|scroll/.test(getComputedStyle(box).overflowY)) box = box.parentElement;
		box.scrollTop = box.scrollHeight;
	});
	await page.getByRole('link', { name: '#1', exact: true }).waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'the last of ten thousand runs is not shown'));
	await page.unroute('**/api/v1/runs?*');
	return { rows, jump_ms: Date.now() - begun };
}

/** Sorts the list by error, compares it with a base run, and saves the view. A new page must offer the same view. */
export async function saveListView(page, base, run) {
	await page.goto(`${base}/runs?search=state:done`);
	const head = page.getByRole('columnheader', { name: /^error/ });
	await head.getByRole('button').click();
	await page.waitForURL(/sort=-error/);
	expect((await head.getAttribute('aria-sort')) === 'descending', 'a list that begins with the largest error does not say so');
	const link = page.locator('main tbody tr a.mono');
	const asked = (await (await fetch(`${base}/api/v1/runs?search=state:done&sort=-error&limit=3`)).json()).runs.map(({ id }) => `#${id}`);
	await page.waitForFunction((first) => document.querySelector('main tbody:last-of-type a.mono')?.textContent === first, asked[0], { timeout: TIMEOUT_MS });
	await page.getByRole('button', { name: `Base: compare the others with run ${run}` }).click();
	await page.getByRole('columnheader', { name: `against #${run}` }).waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'no column tells the change against the base'));
	expect((await link.first().innerText()) === `#${run}`, 'the base does not stay at the top of another order');
	await page.getByText(/^[+−][\d.]+ %$/).first().waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'no run is held against the base'));
	await page.getByRole('button', { name: 'Keep this view' }).click();
	await audit(page, 'the list of runs, ordered');
	await page.goto(`${base}/runs?base=none`);
	await page.getByLabel('Export, views and columns').click();
	await page.getByRole('button', { name: `Show state:done · by error, largest first · against #${run}` }).click();
	await page.waitForURL((url) => url.searchParams.get('sort') === '-error' && url.searchParams.get('base') === String(run) && url.searchParams.get('search') === 'state:done', { timeout: TIMEOUT_MS }).catch(() => expect(false, `a kept view is not the view that was kept: ${page.url()}`));
	await page.getByRole('button', { name: 'Forget this view' }).click();
	await page.getByRole('button', { name: `Base: compare the others with run ${run}` }).click();
	await page.getByRole('columnheader', { name: `against #${run}` }).waitFor({ state: 'detached', timeout: TIMEOUT_MS });
	for (const [name, text, width] of [[`Tags of run ${run}, by commas`, 'walked, golden', 1440], [`Note on run ${run}`, 'walked on it', 420]]) {
		await page.setViewportSize({ width, height: 900 });
		await page.getByRole('button', { name }).click();
		await page.keyboard.type(text);
		await page.keyboard.press('Enter');
	}
	await page.setViewportSize({ width: 1440, height: 900 });
	for (const text of [page.getByRole('link', { name: 'golden' }), page.getByText('walked on it')]) await text.first().waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'a tag or a note that is written in the list is not kept'));
}

/** A column for a quantity, kept over a reload, shows the value of the result page; the list shows no other value of it. */
export async function chooseColumns(page, base, run) {
	await page.goto(`${base}/runs`);
	const cell = (name) => page.locator('main tbody tr', { has: page.getByRole('link', { name: `#${run}`, exact: true }) }).locator(`[data-quantity=${name}]`).first();
	await cell('tau_c').waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'the list does not show the Coulomb friction of a run'));
	await page.getByLabel('Add a column').selectOption('c_v');
	await cell('c_v').waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'a quantity that is chosen has no column'));
	await page.goto(`${base}/runs`);
	const listed = await cell('c_v').innerText({ timeout: TIMEOUT_MS });
	await page.getByRole('button', { name: 'Remove the column Viscous friction' }).click();
	await page.locator('th[data-column=c_v]').waitFor({ state: 'detached', timeout: TIMEOUT_MS });
	await page.goto(`${base}/runs/${run}`);
	const found = page.locator('[data-result] tr[data-quantity=c_v]');
	await found.waitFor({ timeout: TIMEOUT_MS });
	const value = await found.locator('td.number').innerText();
	expect(listed.startsWith(`${value} `), `the list has ${listed} for the viscous friction of run ${run}, its result ${value}`);
}

/** Evaluates the version on a run that is not in its data. Returns the displayed error. */
export async function validateOnRun(page) {
	const choice = page.getByLabel('Validation run');
	await choice.selectOption({ index: 1 });
	const found = page.locator('[data-validated]');
	await found.waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'a version is not evaluated on a validation run'));
	const text = await found.innerText();
	await choice.selectOption('');
	await found.waitFor({ state: 'detached', timeout: TIMEOUT_MS });
	return text;
}

/** Opens the results of short runs of several procedures. Returns the procedures that were shown. */
export async function readResults(page, base, asked) {
	const [shown, runs] = [[], []];
	for (const [procedure, { parameters, title }] of Object.entries(asked)) {
		const run = await makeRun(base, procedure, parameters);
		if (run === null) continue;
		await page.goto(`${base}/runs/${run}`);
		const card = page.locator('[data-result]');
		await card.locator('[data-figure]').first().waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, `${procedure} has no result`));
		const figures = await card.locator('[data-figure] figcaption, [data-figure] h3').allInnerTexts();
		expect(figures.some((figure) => title.test(figure)), `${procedure} shows ${figures.join(', ')}, and not ${title}`);
		await audit(page, `the result of ${procedure}`);
		await page.setViewportSize({ width: 420, height: 900 });
		await page.waitForFunction(() => document.documentElement.scrollWidth <= innerWidth, null, { timeout: TIMEOUT_MS }).catch(() => expect(false, `the result of ${procedure} is too wide for a page of 420 px`));
		await page.setViewportSize({ width: 1440, height: 900 });
		shown.push(procedure);
		runs.push({ procedure, run });
	}
	await readAlignment(page, base, runs.filter(({ procedure }) => procedure.startsWith('encoder')));
	await readCampaign(page, base, runs.slice(0, 2));
	return shown;
}

/** Opens the page of a bench's encoders by key. It shows the newest result of each procedure. */
async function readAlignment(page, base, runs) {
	const [one] = runs;
	if (!one) return;
	const { bench } = await (await fetch(`${base}/api/v1/runs/${one.run}`)).json();
	await page.goto(`${base}/?bench=${bench}`);
	// The serial number of a unit has the focus as soon as it is there; Escape leaves it.
	await page.getByLabel('Unit (serial number)').waitFor({ timeout: TIMEOUT_MS });
	await page.keyboard.press('Escape');
	await page.keyboard.press('6');
	for (const { run } of runs) await page.getByRole('link', { name: `run #${run}` }).waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, `run ${run} is not among the encoder results of ${bench}`));
	await page.waitForFunction((count) => document.querySelectorAll('[data-result] [data-figure]').length > count && !document.querySelector('.unknown'), runs.length, { timeout: TIMEOUT_MS });
	await audit(page, 'the encoder results');
}

/**
 * Displays the result of a campaign, with an answer in place of the daemon's that contains the results of two runs.
 * Each part has a line. It opens by key, and the address stores the open parts.
 */
async function readCampaign(page, base, runs) {
	const of = async ({ procedure, run }, title) => {
		const found = await (await fetch(`${base}/api/v1/runs/${run}/identification`)).json();
		const named = (one) => ({ ...one, name: `${procedure}.${one.name}` });
		const quantities = found.quantities.map((one) => ({ ...named(one), title: `${title}: ${one.title}`, base_title: one.base_title ?? one.title }));
		const figures = found.figures.map(named);
		const names = (all) => all.map(({ name }) => name);
		return {
			summary: `${title}: ${found.summary}`,
			part: { id: procedure, title, verdict: found.verdict, summary: found.summary, quantities: names(quantities), figures: names(figures) },
			quantities,
			figures,
		};
	};
	const parts = await Promise.all(runs.map((one, i) => of(one, `Part ${i + 1}`)));
	const whole = (what) => parts.flatMap((part) => part[what]);
	await page.route('**/identification', (route) =>
		route.fulfill({ json: { run: runs[0].run, procedure: 'identify_joint', software: 'jointbench', verdict: 'identified', advice: null, applies: { can: false, what: 'Nothing of this is applied.' }, summary: whole('summary').join('\n'), lead: '', quantities: whole('quantities'), figures: whole('figures'), parts: parts.map(({ part }) => part) } }),
	);
	await page.goto(`${base}/runs/${runs[0].run}`);
	const lines = page.locator('[data-part]');
	await lines.first().waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'the result of a campaign is not taken apart'));
	expect((await lines.count()) === runs.length && (await lines.locator('[data-figure]').count()) === 0, 'a campaign does not begin with a line for each part');
	await lines.nth(1).locator('summary').first().focus();
	await page.keyboard.press('Enter');
	await lines.nth(1).locator('[data-figure]').first().waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'a part of a campaign does not open by key'));
	await audit(page, 'the result of a campaign');
	await page.reload();
	await lines.nth(1).locator('[data-quantity]').first().waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, `the address forgets which part is open: ${page.url()}`));
	await page.unroute('**/identification');
}

/** Counts the residual curves and the axes that can be selected. */
export async function countCurves(page) {
	const axes = await page.locator('section', { has: page.getByRole('heading', { name: 'Where the model is wrong' }) }).locator('select').first().locator('option').count();
	return { curves: await page.getByTitle("Show on the map's x axis").count(), axes };
}

/** Selects two runs and waits for their common model. */
export async function openTogether(page, base, [first, second]) {
	await page.goto(`${base}/workbench`);
	for (const run of [first, second]) await page.getByLabel(`Together: run ${run}`).check({ timeout: TIMEOUT_MS });
	await audit(page, 'the picker with two runs');
	await page.getByRole('link', { name: 'Fit one model to 2 runs' }).click();
	await page.getByRole('list', { name: 'Runs of the data' }).getByText(`#${second}`).waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'the runs that were ticked together have no model together'));
	expect(!page.url().includes('more='), `the address still asks for what it shows: ${page.url()}`);
}
