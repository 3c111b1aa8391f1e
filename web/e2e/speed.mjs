// Speed of the pages. Needs a running daemon with a mock bench at real time (pace = 1), and for the first part a stored run of millions of rows:
//   node web/e2e/speed.mjs http://127.0.0.1:8080 [/usr/bin/chromium]
// Prints one line per quantity. Chromium draws in software. Other processes affect the durations, but not the processor times.
import { expect, open, settings, runStory } from './browser.mjs';
import { startRun } from './steps.mjs';

const where = settings('usage: node web/e2e/speed.mjs http://127.0.0.1:8080 [path/to/chromium]');
const rest = async (path) => (await fetch(`${where.base}/api/v1${path}`)).json();
const say = (what, figures, unit) => console.log(`${what}: ${[].concat(figures).map((one) => one.toFixed(one < 10 ? 1 : 0)).join(', ')} ${unit}`);
const LIVE_S = 15;
const HANDS = 12;
const median = (list) => list.toSorted((a, b) => a - b)[list.length >> 1];

/** Milliseconds from the start of the page until `done` holds and is painted, and the processor time of the main thread. */
async function opened(page, metrics, address, done) {
	await page.goto(address, { waitUntil: 'commit' });
	await page.waitForFunction(done, null, { timeout: 300_000, polling: 'raf' });
	const wall = await page.evaluate(() => new Promise((ok) => requestAnimationFrame(() => requestAnimationFrame(() => ok(performance.now())))));
	return { wall, own: 1000 * (await metrics()).TaskDuration };
}

/** Chromium's metrics of a page, in processor time of its main thread. */
async function counting(page) {
	const session = await page.context().newCDPSession(page);
	await session.send('Performance.enable', { timeDomain: 'threadTicks' });
	return async () => Object.fromEntries((await session.send('Performance.getMetrics')).metrics.map(({ name, value }) => [name, value]));
}

/** Zooms a plot with the wheel. Returns the milliseconds until the image changes, and until the samples of the new range are drawn. */
async function zoom(page, plot, deltaY) {
	return page.evaluate(
		async ([selector, deltaY]) => {
			const over = document.querySelector(selector);
			const box = over.getBoundingClientRect();
			const asked = () => performance.getEntriesByType('resource').filter((one) => one.name.includes('/samples?')).length;
			const painted = () => new Promise((ok) => requestAnimationFrame(() => setTimeout(ok)));
			performance.clearResourceTimings();
			const begun = performance.now();
			over.dispatchEvent(new WheelEvent('wheel', { deltaY, clientX: box.left + box.width * 0.4, clientY: box.top + 20, bubbles: true, cancelable: true }));
			await painted();
			const moved = performance.now() - begun;
			const until = begun + 5000;
			while (asked() === 0 && performance.now() < until) await painted();
			await painted();
			return { moved, sharp: performance.now() - begun };
		},
		[plot, deltaY],
	);
}

await runStory('speed', async () => {
	const { browser, page, faults } = await open(where);
	const metrics = await counting(page);
	await page.goto(where.base);
	await page.waitForTimeout(500);
	say('first paint of the bench page, nothing cached', await page.evaluate(() => performance.getEntriesByName('first-contentful-paint').map((one) => one.startTime)), 'ms');
	const { runs } = await rest('/runs?search=' + encodeURIComponent('rows>1000000'));
	if (runs.length === 0) console.log('no run of more than a million rows is stored: the first part is left out');
	for (const { id, rows } of runs.slice(0, 1)) {
		const workbench = `${where.base}/workbench/${id}`;
		const there = () => document.querySelector('section[data-verdict]') && document.querySelector('main canvas') && document.querySelectorAll('main .uplot').length >= 2 && !document.querySelector('main .old');
		const measured = () => document.querySelectorAll('main .uplot canvas').length >= 2;
		say(`${rows} rows, workbench for the first time, what was measured`, (await opened(page, metrics, workbench, measured)).wall, 'ms');
		await page.waitForFunction(there, null, { timeout: 300_000, polling: 'raf' });
		say('the same, fitted and diagnosed', await page.evaluate(() => performance.now()), 'ms');
		const again = [];
		for (let i = 0; i < 5; i++) again.push(await opened(page, metrics, workbench, there));
		say('workbench again', again.map(({ wall }) => wall), 'ms');
		say('of that processor time of the main thread', again.map(({ own }) => own), 'ms');
		const near = [];
		for (let i = 0; i < HANDS; i++) near.push((await zoom(page, 'main .uplot .u-over', i % 2 ? 60 : -60)).moved);
		say('zoom in the workbench, p50 and worst', [median(near), Math.max(...near)], 'ms');
		say('run page with its plots', (await opened(page, metrics, `${where.base}/runs/${id}`, () => document.querySelector('main .uplot canvas'))).wall, 'ms');
		await page.waitForTimeout(1500);
		const hands = [];
		for (let i = 0; i < HANDS; i++) hands.push(await zoom(page, 'main .uplot .u-over', i < HANDS / 2 ? -60 : 60));
		for (const [what, key] of [['picture has moved', 'moved'], ['samples of the new view drawn', 'sharp']]) {
			const list = hands.map((one) => one[key]);
			say(`zoom on the run page, ${what}, p50 and worst`, [median(list), Math.max(...list)], 'ms');
		}
	}

	await startRun(page, where.base, '?p.sample_rate_hz=1000&p.repeats=4');
	await page.locator('.uplot').first().waitFor();
	await page.goto(`${page.url()}?hide=none`);
	await page.locator('.uplot').nth(4).waitFor();
	await page.waitForTimeout(3000);
	const channels = await page.locator('main table').first().locator('tr').count();
	const before = await metrics();
	const moved = await page.evaluate(
		(wait_ms) =>
			new Promise((ok) => {
				// An image counts if every plot was painted. Nothing else on the page clears a canvas.
				const plots = document.querySelectorAll('main .uplot').length;
				const { clearRect } = CanvasRenderingContext2D.prototype;
				let [cleared, moved] = [0, 0];
				CanvasRenderingContext2D.prototype.clearRect = function (...box) {
					cleared += 1;
					clearRect.apply(this, box);
				};
				const begun = performance.now();
				const step = (now) => {
					if (cleared >= plots) moved += 1;
					cleared = 0;
					if (now - begun < wait_ms) requestAnimationFrame(step);
					else ok(moved);
				};
				requestAnimationFrame(step);
			}),
		LIVE_S * 1000,
	);
	const after = await metrics();
	expect(/RUNNING/.test(await page.locator('header:has(h1)').last().innerText()), 'the run ended before its plots were watched');
	say(`live, ${channels} channels and time at 1 kHz, pictures a second in which every plot moved`, moved / LIVE_S, '1/s');
	for (const [what, name] of [['processor time of the main thread', 'TaskDuration'], ['of that scripts', 'ScriptDuration']]) say(`${what} for each picture`, (1000 * (after[name] - before[name])) / moved, 'ms');
	const run = Number(/runs\/(\d+)/.exec(page.url())[1]);
	await fetch(`${where.base}/api/v1/runs/${run}/abort`, { method: 'POST' });
	expect(faults.length === 0, `the page is not clean:\n  ${faults.join('\n  ')}`);
	await browser.close();
});
