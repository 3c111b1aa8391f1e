// Actions of a user, for the walk and for the screenshots.
import { expect, TIMEOUT_MS } from './browser.mjs';
import { dropFiles, FOREIGN } from './files.mjs';
import { expectInView } from './checks.mjs';
import { proxyTo } from './proxy.mjs';

const RUN_MS = 180_000;
const FIT_MS = 60_000;
const PHONE = { width: 420, height: 900 };
const WIDE = { width: 1440, height: 900 };

/** A short run without load. It cannot show effects that depend on the load, so a further run is recommended. */
export const WITHOUT_LOAD = '?p.load_levels=1&p.warm_up_s=2&p.dwell_s=0.6&p.fast_speeds=4';

/** A run without repeats: its noise floor is unknown. */
export const WITHOUT_REPEATS = { speeds: 2, repeats: 1 };

/** Starts the offered procedure, with the settings of the address if given. Returns the number of the run. */
export async function startRun(page, base, settings = '') {
	await page.goto(`${base}/${settings}`);
	const start = page.getByRole('button', { name: 'Start' });
	try {
		await page.waitForFunction(() => document.querySelector('.go .primary:enabled'), null, { timeout: 30_000 });
	} catch {
		const reason = await page.locator('#start-reason').textContent({ timeout: 500 }).catch(() => 'the page has no Start');
		expect(false, `Start stays disabled: ${reason}`);
	}
	await start.click();
	await page.waitForURL(/\/runs\/\d+/, { timeout: 30_000 });
	return Number(/runs\/(\d+)/.exec(page.url())[1]);
}

/** Executes a run through REST and waits for its end. Returns `null` if no bench can execute it. */
export async function makeRun(base, procedure, parameters) {
	const rest = async (path, body) => {
		const answer = await fetch(`${base}/api/v1${path}`, body && { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(body) });
		return { ok: answer.ok, json: await answer.json() };
	};
	const { json: benches } = await rest('/bench');
	for (const { name } of benches) {
		const { ok, json: run } = await rest('/runs', { bench: name, procedure, parameters });
		if (!ok) {
			console.log(`no ${procedure} on ${name}: ${run.detail}`);
			continue;
		}
		const until = Date.now() + RUN_MS;
		while (Date.now() < until) {
			const { json } = await rest(`/runs/${run.id}`);
			if (json.state === 'completed') return run.id;
			expect(!/stopped|aborted|failed|interrupted/.test(json.state), `${procedure} on ${name} ended ${json.state}: ${json.reason}`);
			await new Promise((resolve) => setTimeout(resolve, 500));
		}
		expect(false, `${procedure} on ${name} did not end in ${RUN_MS / 1000} s`);
	}
	return null;
}

/** Waits until the run of the page is complete, and opens its result by key. Returns the link to the workbench. */
async function openResult(page, before = async () => {}) {
	await page.getByRole('button', { name: 'Show the result' }).waitFor({ timeout: RUN_MS }).catch(async () => {
		expect(false, `the run did not end in ${RUN_MS / 1000} s: ${await page.locator('h1').locator('..').innerText()}`);
	});
	await page.waitForTimeout(1500);
	await before();
	await page.keyboard.press('r');
	const open = page.getByRole('link', { name: 'Open in the workbench' });
	await open.waitFor({ timeout: RUN_MS });
	return open;
}

/** Waits on the live page until the run is complete, and opens its result. */
export async function watchRun(page) {
	await page.locator('.uplot').first().waitFor({ timeout: 30_000 }).catch(() => expect(false, 'no live plot was drawn'));
	const shift = await page.evaluateHandle(() => {
		const seen = { sum: 0 };
		new PerformanceObserver((list) => list.getEntries().forEach((one) => (seen.sum += one.hadRecentInput ? 0 : one.value))).observe({ type: 'layout-shift' });
		return seen;
	});
	const open = await openResult(page, async () => {
		const jumps = await shift.evaluate(({ sum }) => sum);
		expect(jumps < 0.1, `the page jumps during a run or at its end, by ${jumps}`);
		console.log(`layout shift of a run and its end: ${jumps.toFixed(4)}`);
	});
	const head = await page.locator('header:has(h1)').last().innerText();
	expect(head.includes('DONE'), `the run did not complete: ${head.replaceAll('\n', ' ')}`);
	return open;
}

/** Zooms only the second plot. The others must not change. */
export async function zoomOnePlot(page) {
	const plot = page.locator('figure:has(.uplot)').nth(1);
	await plot.locator('summary').click();
	await plot.getByRole('button', { name: 'Zoom on its own' }).click();
	await page.waitForURL(/own=/);
	await plot.locator('.u-over').hover();
	await page.mouse.wheel(0, -300);
	await page.waitForURL(/own=[^&]*:[\d.]+:[\d.]+/, { timeout: TIMEOUT_MS }).catch(() => expect(false, `the wheel does not zoom the plot: ${page.url()}`));
	expect(!/view=/.test(page.url()), `the other plots are zoomed with it: ${page.url()}`);
	await plot.locator('.u-over').dblclick();
	await page.waitForURL(/own=[^&]*:all/, { timeout: TIMEOUT_MS }).catch(() => expect(false, `a double click does not step back: ${page.url()}`));
}

/** Reads a result by keyboard: shows its first figure as a table, and as a figure again. Returns the verdict and the number of table rows. */
export async function readResult(page) {
	const card = page.locator('[data-result]');
	await card.locator('[data-figure]').first().waitFor({ timeout: FIT_MS }).catch(() => expect(false, 'the run has no result'));
	const choose = async (item) => {
		await card.locator('[data-figure] summary').first().focus();
		await page.keyboard.press('Enter');
		for (let i = 0; i < 8; i++) {
			await page.keyboard.press('Tab');
			if ((await page.evaluate(() => document.activeElement.textContent)) === item) return page.keyboard.press('Enter');
		}
		expect(false, `no ${item} in the menu of a figure can be reached by keyboard`);
	};
	await choose('View as table');
	const rows = await card.locator('[data-figure] tbody tr').count();
	await choose('View as figure');
	await card.locator('[data-figure] svg').first().waitFor();
	return { verdict: await card.getAttribute('data-result'), quantities: await card.locator('[data-quantity]').count(), rows };
}

/** Waits until the displayed version is fitted and diagnosed. Returns the displayed values. */
export async function readVersion(page) {
	await page.locator('section[data-verdict]').waitFor({ timeout: FIT_MS });
	await page.locator('rect.held.here').waitFor({ timeout: FIT_MS });
	// A version that another client made is in the address before the page knows it.
	const isThere = () => document.querySelector(`a[href$="model=${new URL(location.href).searchParams.get('model')}"] rect.held.here`) && !document.querySelector('main .old');
	await page.waitForFunction(isThere, null, { timeout: FIT_MS });
	return {
		model: new URL(page.url()).searchParams.get('model'),
		verdict: await page.locator('section[data-verdict]').getAttribute('data-verdict'),
		held: Number(await page.locator('rect.held.here').getAttribute('data-held')),
		effects: await page.locator('article[data-effect]').evaluateAll((cards) => cards.map((card) => card.dataset.effect)),
	};
}

/** Executes `act`, which leads to another version, and waits for that version. */
export async function waitForOtherVersion(page, act, patience_ms = FIT_MS) {
	const before = new URL(page.url()).searchParams.get('model');
	await act();
	await page.waitForFunction((id) => new URL(location.href).searchParams.get('model') !== id, before, { timeout: patience_ms });
	return readVersion(page);
}

/** Another client makes a version with one more effect. The page must display it when the address names it, without a third version in between. Returns to the former version. */
export async function showForeign(page, base, run, at, effect) {
	const ask = async (path, body) => (await fetch(`${base}/api/v1${path}`, body && { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(body) })).json();
	const from = (await ask(`/models?run=${run}`)).find((model) => String(model.id) === at.model);
	const made = await ask('/models', { run, effects: [...from.effects, effect], parent: from.id, more_runs: from.more_runs });
	await page.evaluate((model) => {
		window.shown = new Set();
		const look = () => {
			window.shown.add(document.querySelector('h1').innerText);
			requestAnimationFrame(look);
		};
		look();
		history.pushState(null, '', `${location.pathname}?model=${model}`);
		dispatchEvent(new PopStateEvent('popstate'));
	}, made.id);
	const there = await readVersion(page);
	expect(there.model === String(made.id), `the page shows version ${there.model}, not ${made.id}, which was made elsewhere`);
	const shown = await page.evaluate(() => [...window.shown]);
	expect(shown.length === 2, `on its way to version ${made.id} the page shows ${shown.join(', ')}`);
	await page.goBack();
	return readVersion(page);
}

/** Tries the first suggestion and drops it. Returns the text of the comparison. */
export async function tryAndDrop(page) {
	await page.setViewportSize(PHONE);
	await page.locator('article[data-effect]').first().getByRole('button', { name: 'Try' }).click();
	await page.locator('[data-beside=try] figure').first().waitFor({ timeout: FIT_MS });
	await expectInView(page.locator('[data-beside=try]'), 'the preview');
	await page.setViewportSize(WIDE);
	const text = await page.locator('[data-beside] .status').innerText();
	await page.keyboard.press('x');
	await page.locator('[data-beside]').waitFor({ state: 'detached' });
	return text;
}

/** Layout shift of the page since it was opened, without shifts after user input. */
export const layoutShiftOf = (page) => page.evaluate(() => new Promise((ok) => {
	new PerformanceObserver((list) => ok(list.getEntries().reduce((sum, one) => sum + (one.hadRecentInput ? 0 : one.value), 0))).observe({ type: 'layout-shift', buffered: true });
	setTimeout(() => ok(0), 1000);
}));

/** Layout shift of an opening workbench, on a desktop and on a phone. */
export async function openWorkbench(another, address) {
	const jumps = [];
	for (const size of [WIDE, PHONE]) {
		const page = await another();
		await page.setViewportSize(size);
		await page.goto(address);
		await readVersion(page);
		await page.locator('[data-worth]').first().waitFor({ timeout: FIT_MS });
		jumps.push(await layoutShiftOf(page));
		await page.close();
	}
	return jumps;
}

/** Opens the page of a daemon without runs and starts the demo run. Returns the layout shift and the content security policy. */
export async function firstUse(page, base) {
	const answer = await page.goto(base);
	await page.getByText('No run yet. Start a procedure, or import a measurement.').waitFor({ timeout: 30_000 });
	await page.getByRole('button', { name: 'Start a demo run' }).waitFor({ timeout: 30_000 });
	await page.waitForFunction(() => document.querySelector('.go .primary:enabled'), null, { timeout: 30_000 });
	const jumps = await layoutShiftOf(page);
	const started = page.waitForRequest((request) => request.method() === 'POST' && request.url().endsWith('/runs'), { timeout: 1000 });
	await page.locator('.fields input').first().press('Enter');
	expect(await started.then(() => false, () => true), 'Enter in a field starts the bench, which only its button may');
	// A slow line: the button is there before the procedures.
	const procedures = '**/api/v1/procedures?*';
	await page.route(procedures, (route) => void setTimeout(() => route.continue().catch(() => undefined), 1500));
	await page.goto(`${base}/live`);
	await page.getByRole('link', { name: 'Start a demo run' }).click();
	await page.getByRole('button', { name: 'Start a demo run' }).click();
	await page.waitForURL(/\/runs\/\d+/, { timeout: 30_000 }).catch(() => expect(false, 'the demo run does not start where it is pressed'));
	await page.unroute(procedures);
	await openResult(page);
	return { jumps, policy: answer.headers()['content-security-policy'] ?? '' };
}

/** Animations that still run for a user who prefers reduced motion. */
export async function runningAnimations(page) {
	await page.emulateMedia({ reducedMotion: 'reduce' });
	await page.waitForTimeout(500);
	return page.evaluate(() => document.getAnimations().filter((one) => one.playState === 'running').map((one) => one.animationName ?? one.transitionProperty));
}

/** Compares the current version with another one and closes the comparison. Returns its text. */
export async function compareVersions(page) {
	await page.getByRole('button', { name: /^Compare with v/ }).and(page.locator(':enabled')).last().click();
	const beside = page.locator('[data-beside=compare]');
	await beside.waitFor({ timeout: 30_000 }).catch(() => expect(false, 'no other version is shown beside the one at hand'));
	await beside.locator('tbody tr').first().waitFor({ timeout: FIT_MS }).catch(() => expect(false, 'the parameters of the two versions are not told'));
	const text = await beside.innerText();
	await page.keyboard.press('x');
	await beside.waitFor({ state: 'detached' });
	return text;
}

/** A second user, in a separate browser, who only observes. */
export async function observe(page, base) {
	await page.goto(base);
	await page.getByRole('button', { name: 'Operator' }).click();
	await page.getByText('Observer mode').waitFor({ timeout: 30_000 });
	expect(await page.getByRole('button', { name: 'Start' }).isDisabled(), 'an observer can start');
	await dropFiles(page, base, [['foreign.csv', FOREIGN]]);
	const form = page.getByRole('form', { name: /foreign.csv/ });
	for (const [name, value] of [['torque constant', '0.08'], ['gear ratio', '50'], ['rotor inertia', '4e-5']]) await form.getByLabel(name).fill(value);
	await form.getByRole('button', { name: 'Import' }).click();
	await form.getByText('Observer mode').waitFor({ timeout: 30_000 }).catch(() => expect(false, 'an observer can import'));
	await page.goto(base);
}

/** Interrupts the connection of a page and restores it. Meanwhile the page must not start a run, and afterwards it must know the changes. Returns the displayed reason. */
export async function loseAndRestoreContact(another, base) {
	const line = await proxyTo(base);
	const faults = [];
	const page = await another(line.base, faults);
	await page.goto(line.base);
	const start = page.getByRole('button', { name: 'Start' });
	await page.waitForFunction(() => document.querySelector('.go .primary:enabled'), null, { timeout: 30_000 });
	await line.cut();
	await page.getByText('NO CONTACT').first().waitFor({ timeout: 30_000 }).catch(() => expect(false, 'the page does not say that the daemon is gone'));
	expect(await start.isDisabled(), 'a run can be started without a daemon');
	const text = await page.locator('#start-reason').innerText();
	const run = await makeRun(base, 'strokes', WITHOUT_REPEATS);
	expect(await page.getByText('NO CONTACT').first().isVisible(), 'the page has contact over a line that is cut');
	await line.restore();
	await page.getByText('NO CONTACT').first().waitFor({ state: 'detached', timeout: 30_000 }).catch(() => expect(false, 'the page does not find the daemon again'));
	await page.getByRole('link', { name: `#${run}` }).waitFor({ timeout: 30_000 }).catch(() => expect(false, `the page does not know run ${run}, which was made while it had no contact`));
	expect(!faults.some((fault) => fault.startsWith('exception')), `the page did not bear the loss:\n  ${faults.join('\n  ')}`);
	await line.cut();
	await page.close();
	return text;
}

/**
 * The software stop by keyboard. Esc twice stops neither an idle bench nor a bench while a field has the focus. `keys` then stop the run.
 * Needs the bench `paced`, because its runs last long enough.
 */
export async function stopByKey(page, base, who, keys) {
	const state = async () => (await (await fetch(`${base}/api/v1/bench/paced`)).json()).state;
	const escapeTwice = async () => {
		await page.keyboard.press('Escape');
		await page.keyboard.press('Escape');
		await page.waitForTimeout(300);
	};
	await page.goto(`${base}/?bench=paced`);
	await page.locator('header .state', { hasText: 'IDLE' }).first().waitFor({ timeout: 30_000 });
	await escapeTwice();
	expect((await state()) === 'idle', `Esc twice of the ${who} stops a bench at rest`);
	const headers = { 'content-type': 'application/json' };
	const body = JSON.stringify({ bench: 'paced', procedure: 'friction', parameters: {} });
	const run = await (await fetch(`${base}/api/v1/runs`, { method: 'POST', headers, body })).json();
	await page.goto(`${base}/runs/${run.id}`);
	await page.locator('header .state', { hasText: 'RUNNING' }).first().waitFor({ timeout: 30_000 });
	await page.keyboard.press('?');
	await page.getByRole('heading', { name: 'Keys' }).waitFor({ timeout: 30_000 });
	await escapeTwice();
	expect((await state()) === 'running', `the Esc of the ${who} that closes the help sheet counts for a stop`);
	for (const key of keys) await page.keyboard.press(key);
	const text = page.getByText(/acknowledged (in|late)/i).first();
	await text.waitFor({ timeout: 30_000 }).catch(() => expect(false, `nobody acknowledged the stop of the ${who}`));
	await page.getByRole('button', { name: 'The bench stands still' }).click({ timeout: 500 }).catch(() => {});
}

/** Resets every stopped bench. Until then no run can start, and the page shows the reason. A reset needs two steps and a reason. Returns the number of stopped benches. */
export async function resetStopped(page, base) {
	const benches = await (await fetch(`${base}/api/v1/bench`)).json();
	const stopped = benches.filter(({ state }) => state === 'stopped');
	for (const { name } of stopped) {
		await page.goto(`${base}/?bench=${name}`);
		const held = page.getByRole('region', { name: 'Bench stopped' });
		await held.waitFor({ timeout: 30_000 }).catch(() => expect(false, `the page does not say that ${name} is stopped`));
		await page.locator('header .state', { hasText: 'STOPPED' }).waitFor({ timeout: 30_000 });
		await page.locator('#start-reason', { hasText: 'the bench is stopped' }).waitFor({ timeout: 30_000 });
		expect(await page.getByRole('button', { name: 'Start' }).isDisabled(), `a run can be started on ${name}, which is stopped`);
		const reset = held.getByRole('button', { name: 'Reset the bench' });
		await held.getByLabel('Findings and action taken').fill('walked past');
		expect(await reset.isDisabled(), 'one step is enough to reset a bench');
		await held.getByLabel('I have inspected the bench').check();
		await reset.click();
		await held.waitFor({ state: 'detached', timeout: 30_000 });
		await page.waitForFunction(() => document.querySelector('.go .primary:enabled'), null, { timeout: 30_000 });
		await page.goto(`${base}/log`);
		await page.getByText('walked past (local)').first().waitFor({ timeout: 30_000 }).catch(() => expect(false, 'the log does not show the reset, and by whom'));
	}
	return stopped.length;
}

/** Selects samples by a drag over the residual plot. Returns the displayed number of selected samples. */
export async function brush(page) {
	const plot = page.locator('section', { has: page.getByRole('heading', { name: 'Measured against model' }) }).locator('.uplot .u-over').last();
	await plot.scrollIntoViewIfNeeded();
	const box = await plot.boundingBox();
	await page.mouse.move(box.x + box.width * 0.55, box.y + box.height / 2);
	await page.mouse.down();
	await page.mouse.move(box.x + box.width * 0.95, box.y + box.height / 2, { steps: 4 });
	await page.mouse.up();
	await page.waitForURL(/region=/);
	const note = await page.getByText(/\d selected/).first().innerText();
	return Number(/([\d,]+) selected/.exec(note)[1].replaceAll(',', ''));
}

/** Excludes the selected samples with a reason and undoes it. Returns the displayed exclusions. */
export async function excludeAndUndo(page, reason) {
	await page.getByRole('button', { name: 'Exclude …' }).click();
	await page.getByRole('form', { name: 'Exclude the selected samples' }).getByRole('textbox').fill(reason);
	await waitForOtherVersion(page, () => page.keyboard.press('Enter'));
	const text = await page.getByRole('list', { name: 'Excluded samples' }).innerText();
	await page.locator('figcaption').getByText('excluded').first().waitFor({ timeout: 30_000 }).catch(() => expect(false, 'excluded samples are not marked in the plots'));
	await waitForOtherVersion(page, () => page.keyboard.press('z'));
	return text;
}

/** Starts the recommended run and waits for the model of both runs. Returns the text of the card and the new version. */
export async function measureNext(page) {
	const card = page.locator('[data-experiment]');
	await card.waitFor({ timeout: FIT_MS }).catch(() => expect(false, 'no run is suggested'));
	await card.locator('.uplot').first().waitFor({ timeout: FIT_MS });
	const text = await card.innerText();
	const go = card.getByRole('button', { name: 'Run it and diagnose both runs together' });
	await page.setViewportSize(PHONE);
	const version = await waitForOtherVersion(page, () => go.click(), RUN_MS);
	await expectInView(page.locator('section[data-verdict]'), 'the answer of the further run');
	await page.setViewportSize(WIDE);
	return { text, ...version };
}

/** Starts an autopilot with a budget, waits until it measures, and stops it. Returns its final text. */
export async function startAndStopAutopilot(page, address) {
	await page.goto(address);
	const form = page.getByRole('form', { name: 'Autopilot' });
	await form.getByLabel('max. runs').fill('2');
	await form.getByLabel('bench time').fill('20');
	// A mock bench without pace measures within a moment, so every image is checked, and Stop is pressed in it.
	const measuring = () => {
		const running = document.querySelector('[data-autopilot=running]');
		const text = running?.textContent ?? '';
		if (!text.includes('Measuring') || !/step \d+ of \d+/.test(text)) return false;
		[...running.querySelectorAll('button')].find((button) => button.textContent.trim() === 'Stop')?.click();
		return true;
	};
	const measures = page.waitForFunction(measuring, null, { polling: 'raf', timeout: 30_000 });
	await form.getByRole('button', { name: 'Start the autopilot' }).click();
	await measures.catch(() => expect(false, 'the autopilot does not measure'));
	const ended = page.locator('[data-autopilot=stopped]');
	await ended.waitFor({ timeout: RUN_MS }).catch(() => expect(false, 'the autopilot does not stop'));
	return ended.innerText();
}

/** Runs an autopilot without runs to its end. The page must follow it to its last version. Returns the version and its text. */
export async function runAutopilotToEnd(page, address) {
	await page.goto(address);
	await readVersion(page);
	const form = page.getByRole('form', { name: 'Autopilot' });
	await form.getByLabel('bench time').fill('0.01');
	const ended = await waitForOtherVersion(page, () => form.getByRole('button', { name: 'Start the autopilot' }).click(), RUN_MS);
	await page.getByText('The autopilot has ended with this version.').waitFor({ timeout: 30_000 });
	return { ...ended, text: await page.locator('[data-autopilot]').innerText() };
}

/** Removes the last effect of the model and undoes it. Returns the layout shift. */
export async function removeAndUndo(page) {
	const before = await layoutShiftOf(page);
	await waitForOtherVersion(page, () => page.getByRole('list', { name: 'Effects of the model' }).getByRole('button').last().click());
	await page.waitForTimeout(700);
	await waitForOtherVersion(page, () => page.keyboard.press('z'));
	await page.waitForTimeout(700);
	return (await layoutShiftOf(page)) - before;
}

/** Enters a user's effect with an error, corrects it, tries it on the run, and adds it. */
export async function writeEffect(page, run) {
	await page.getByRole('button', { name: 'Own formula' }).click();
	const form = page.getByRole('form', { name: 'Own formula' });
	const formula = form.getByLabel('formula', { exact: true });
	await page.keyboard.type('Walked load');
	const name = await form.getByLabel('name', { exact: true }).inputValue();
	expect(name === 'Walked load', `what is typed after opening the own formula goes elsewhere: ${name}`);
	await form.getByLabel('name', { exact: true }).fill('');
	await formula.fill('tau = a * direction * abs(load');
	await form.getByText('character 31').waitFor({ timeout: FIT_MS }).catch(() => expect(false, 'the mistake is not marked at its character'));
	expect((await form.locator('mark').count()) === 1, 'nothing is marked in the formula');
	await form.getByLabel('name', { exact: true }).fill(name);
	await formula.fill('a * direction');
	await form.getByRole('button', { name: 'Declare a as a parameter' }).click();
	const keep = form.getByRole('button', { name: 'Keep and add' });
	await keep.click();
	await form.getByText('Confounded with Coulomb friction').waitFor({ timeout: FIT_MS }).catch(() => expect(false, 'an effect that is another one is kept without a word'));
	await formula.fill('tau = a * direction * abs(load)');
	await form.getByRole('button', { name: `Try on run #${run}` }).click();
	const found = await form.locator('.tried').innerText({ timeout: FIT_MS });
	expect(/a = \d/.test(found), `the formula is not fitted to the run: ${found}`);
	expect(/Validation error .+ → .+ \([−+][\d.]+ %\)/.test(found), `the trial does not say what the error does: ${found}`);
	return waitForOtherVersion(page, () => keep.click());
}
