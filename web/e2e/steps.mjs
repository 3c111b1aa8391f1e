// What a person does on the pages, for the walk and for the pictures.
import { expect, TIMEOUT_MS } from './browser.mjs';
import { dropFiles, FOREIGN } from './files.mjs';
import { expectInView } from './looks.mjs';
import { proxyTo } from './proxy.mjs';

const RUN_MS = 180_000;
const FIT_MS = 60_000;
const PHONE = { width: 420, height: 900 };
const WIDE = { width: 1440, height: 900 };

/** Short, and without load: what grows with the load cannot show in it, so a further run is suggested. */
export const WITHOUT_LOAD = '?p.load_levels=1&p.warm_up_s=2&p.dwell_s=0.6&p.fast_speeds=4';

/** A run without repeats: nobody knows how small its error could become. */
export const WITHOUT_REPEATS = { speeds: 2, repeats: 1 };

/** Starts the procedure that is offered, as it is offered or with settings as the address carries them. Gives the run's number. */
export async function startRun(page, base, settings = '') {
	await page.goto(`${base}/${settings}`);
	const start = page.getByRole('button', { name: 'Start' });
	try {
		await page.waitForFunction(() => document.querySelector('.go button:enabled'), null, { timeout: 30_000 });
	} catch {
		const reason = await page.locator('#start-reason').textContent({ timeout: 500 }).catch(() => 'the page has no Start');
		expect(false, `Start stays disabled: ${reason}`);
	}
	await start.click();
	await page.waitForURL(/\/runs\/\d+/, { timeout: 30_000 });
	return Number(/runs\/(\d+)/.exec(page.url())[1]);
}

/** Makes a run through REST and waits for its end; `null` where no bench of the daemon can make it. */
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

/** Waits on the live page until the run has completed. */
export async function watchRun(page) {
	const open = page.getByRole('link', { name: 'Open in the workbench' });
	await page.locator('.uplot').first().waitFor({ timeout: 30_000 }).catch(() => expect(false, 'no live plot was drawn'));
	await open.waitFor({ timeout: RUN_MS }).catch(async () => {
		expect(false, `the run did not end in ${RUN_MS / 1000} s: ${await page.locator('h1').locator('..').innerText()}`);
	});
	const head = await page.locator('header:has(h1)').last().innerText();
	expect(head.includes('DONE'), `the run did not complete: ${head.replaceAll('\n', ' ')}`);
	return open;
}

/** Zooms the second plot on its own; the others stay as they were. */
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

/** Reads the result on a run's page, by keyboard alone: its first figure as a table, and back. Says the verdict and how many numbers the table has. */
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

/** Waits until the version on the screen is fitted and diagnosed; says what the screen shows of it. */
export async function readVersion(page) {
	await page.locator('section[data-verdict]').waitFor({ timeout: FIT_MS });
	await page.locator('rect.held.here').waitFor({ timeout: FIT_MS });
	// A version that was made elsewhere is in the address before the page has heard of it.
	const isThere = () => document.querySelector(`a[href$="model=${new URL(location.href).searchParams.get('model')}"] rect.held.here`) && !document.querySelector('main .old');
	await page.waitForFunction(isThere, null, { timeout: FIT_MS });
	return {
		model: new URL(page.url()).searchParams.get('model'),
		verdict: await page.locator('section[data-verdict]').getAttribute('data-verdict'),
		held: Number(await page.locator('rect.held.here').getAttribute('data-held')),
		effects: await page.locator('article[data-effect]').evaluateAll((cards) => cards.map((card) => card.dataset.effect)),
	};
}

/** Does something that leads to another version, and waits for it. */
export async function waitForOtherVersion(page, act, patience_ms = FIT_MS) {
	const before = new URL(page.url()).searchParams.get('model');
	await act();
	await page.waitForFunction((id) => new URL(location.href).searchParams.get('model') !== id, before, { timeout: patience_ms });
	return readVersion(page);
}

/** A version that somebody else makes of the one at hand, with an effect more: shown when the address names it, and meanwhile no third in its place. Goes back. */
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

/** Tries the first suggestion beside the version at hand and drops it again; says what error the preview shows. */
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

/** How far things have jumped on this page since it was opened, by what nobody did. */
export const layoutShiftOf = (page) => page.evaluate(() => new Promise((ok) => {
	new PerformanceObserver((list) => ok(list.getEntries().reduce((sum, one) => sum + (one.hadRecentInput ? 0 : one.value), 0))).observe({ type: 'layout-shift', buffered: true });
	setTimeout(() => ok(0), 1000);
}));

/** How far things jump while the workbench of a run opens, on a desk and on a phone. */
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

/** The page of a daemon without any run: what it says, how far things jump while it loads, and what it may load at all. Its demo run is made. */
export async function firstUse(page, base) {
	const answer = await page.goto(base);
	await page.getByText('No run yet. Start a procedure, or bring a measurement.').waitFor({ timeout: 30_000 });
	await page.getByRole('button', { name: 'Start a demo run' }).waitFor({ timeout: 30_000 });
	await page.waitForFunction(() => document.querySelector('.go button:enabled'), null, { timeout: 30_000 });
	const jumps = await layoutShiftOf(page);
	const started = page.waitForRequest((request) => request.method() === 'POST' && request.url().endsWith('/runs'), { timeout: 1000 });
	await page.locator('.fields input').first().press('Enter');
	expect(await started.then(() => false, () => true), 'Enter in a field starts the bench, which only its button may');
	await page.goto(`${base}/live`);
	await page.getByRole('link', { name: 'Start a demo run' }).click();
	await page.getByRole('button', { name: 'Start a demo run' }).click();
	await page.waitForURL(/\/runs\/\d+/, { timeout: 30_000 }).catch(() => expect(false, 'the demo run does not start where it is pressed'));
	await page.getByRole('link', { name: 'Open in the workbench' }).waitFor({ timeout: RUN_MS });
	return { jumps, policy: answer.headers()['content-security-policy'] ?? '' };
}

/** Whatever still moves by itself for a person who has asked for little motion. */
export async function runningAnimations(page) {
	await page.emulateMedia({ reducedMotion: 'reduce' });
	await page.waitForTimeout(500);
	return page.evaluate(() => document.getAnimations().filter((one) => one.playState === 'running').map((one) => one.animationName ?? one.transitionProperty));
}

/** Holds the version at hand beside another one, and lets it go again; what the page says of the two. */
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

/** A second person, in a browser of their own, who only looks. */
export async function observe(page, base) {
	await page.goto(base);
	await page.getByRole('button', { name: 'Operator' }).click();
	await page.getByText('this browser only observes').waitFor({ timeout: 30_000 });
	expect(await page.getByRole('button', { name: 'Start' }).isDisabled(), 'an observer can start');
	await dropFiles(page, base, [['foreign.csv', FOREIGN]]);
	const form = page.getByRole('form', { name: /foreign.csv/ });
	for (const [name, value] of [['torque constant', '0.08'], ['gear ratio', '50'], ['rotor inertia', '4e-5']]) await form.getByLabel(name).fill(value);
	await form.getByRole('button', { name: 'Import' }).click();
	await form.getByText('this browser only observes').waitFor({ timeout: 30_000 }).catch(() => expect(false, 'an observer can import'));
	await page.goto(base);
}

/** A page whose line to the daemon is cut and comes back: it says so, lets nothing start, and then knows what went on without it. Gives what it said. */
export async function loseAndRestoreContact(another, base) {
	const line = await proxyTo(base);
	const faults = [];
	const page = await another(line.base, faults);
	await page.goto(line.base);
	const start = page.getByRole('button', { name: 'Start' });
	await page.waitForFunction(() => document.querySelector('.go button:enabled'), null, { timeout: 30_000 });
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
 * The software stop by key alone. Esc twice stops neither a bench at rest nor one whose field has the focus; `keys` then stop the run.
 * Needs the bench `paced`, whose runs last.
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

/** Every bench that the software stop holds: nothing starts, and the page says why, until it is reset in two steps and with a reason. Gives how many were held. */
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
		await held.getByLabel('What was found and done').fill('walked past');
		expect(await reset.isDisabled(), 'one step is enough to reset a bench');
		await held.getByLabel('I have looked at the bench').check();
		await reset.click();
		await held.waitFor({ state: 'detached', timeout: 30_000 });
		await page.waitForFunction(() => document.querySelector('.go button:enabled'), null, { timeout: 30_000 });
		await page.goto(`${base}/log`);
		await page.getByText('walked past (local)').first().waitFor({ timeout: 30_000 }).catch(() => expect(false, 'the log does not show the reset, and by whom'));
	}
	return stopped.length;
}

/** Drags over the residual below the overlay; says how many samples the page calls chosen. */
export async function brush(page) {
	const plot = page.locator('section', { has: page.getByRole('heading', { name: 'Measured against model' }) }).locator('.uplot .u-over').last();
	await plot.scrollIntoViewIfNeeded();
	const box = await plot.boundingBox();
	await page.mouse.move(box.x + box.width * 0.55, box.y + box.height / 2);
	await page.mouse.down();
	await page.mouse.move(box.x + box.width * 0.95, box.y + box.height / 2, { steps: 4 });
	await page.mouse.up();
	await page.waitForURL(/region=/);
	const note = await page.getByText(/\d chosen/).first().innerText();
	return Number(/([\d,]+) chosen/.exec(note)[1].replaceAll(',', ''));
}

/** Takes the chosen samples out of the fit with a reason, and goes back; says what the page calls excluded. */
export async function excludeAndUndo(page, reason) {
	await page.getByRole('button', { name: 'Exclude …' }).click();
	await page.getByRole('form', { name: 'Exclude the chosen samples' }).getByRole('textbox').fill(reason);
	await waitForOtherVersion(page, () => page.keyboard.press('Enter'));
	const text = await page.getByRole('list', { name: 'What the fit does not look at' }).innerText();
	await page.locator('figcaption').getByText('excluded').first().waitFor({ timeout: 30_000 }).catch(() => expect(false, 'excluded samples are not marked in the plots'));
	await waitForOtherVersion(page, () => page.keyboard.press('z'));
	return text;
}

/** Has the run made that would tell, and waits for the same model on both runs; says what the card promised. */
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

/** Starts an autopilot within a budget on the page of the workbench that the address names, sees it measure, and ends it; says there where it ended. */
export async function startAndStopAutopilot(page, address) {
	await page.goto(address);
	const form = page.getByRole('form', { name: 'Autopilot' });
	await form.getByLabel('runs, at most').fill('2');
	await form.getByLabel('bench time').fill('20');
	// A mock bench that keeps to no clock measures within a moment: every picture is looked at, and the stop pressed in it.
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

/** Lets an autopilot that may make no run go to its end from the first version of a run; the page has to follow it there. Gives the version and what is said of it. */
export async function runAutopilotToEnd(page, address) {
	await page.goto(address);
	await readVersion(page);
	const form = page.getByRole('form', { name: 'Autopilot' });
	await form.getByLabel('bench time').fill('0.01');
	const ended = await waitForOtherVersion(page, () => form.getByRole('button', { name: 'Start the autopilot' }).click(), RUN_MS);
	await page.getByText('The autopilot has ended with this version.').waitFor({ timeout: 30_000 });
	return { ...ended, text: await page.locator('[data-autopilot]').innerText() };
}

/** Takes the last effect out of the model, and comes back; how far things jump on the way. */
export async function removeAndUndo(page) {
	const before = await layoutShiftOf(page);
	await waitForOtherVersion(page, () => page.getByRole('list', { name: 'Effects of the model' }).getByRole('button').last().click());
	await page.waitForTimeout(700);
	await waitForOtherVersion(page, () => page.keyboard.press('z'));
	await page.waitForTimeout(700);
	return (await layoutShiftOf(page)) - before;
}

/** Writes an effect of one's own with a mistake in it, mends it, tries it on the run and adds it. */
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
	return waitForOtherVersion(page, () => keep.click());
}
