// Functions of plots: hide a channel, go to a step, derive a channel, plot one channel over another, show a quantity over runs.
import { audit } from './audit.mjs';
import { expect, TIMEOUT_MS } from './browser.mjs';

const imageOf = (plot) => plot.locator('canvas').first().evaluate((canvas) => canvas.toDataURL());

/** Hides a channel by its legend entry and shows it again. The address stores it. */
export async function hideChannel(page) {
	const plot = page.locator('#plots figure:has(.uplot)', { has: page.getByRole('button', { name: /set ?point/ }) }).first();
	await plot.waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'no plot names its set point'));
	expect((await plot.getByRole('button', { name: /^limit/ }).count()) > 0, 'no plot names its limit');
	const before = await imageOf(plot);
	const entry = plot.getByRole('button', { name: /set ?point/ }).first();
	await entry.click();
	await page.waitForURL(/off=/, { timeout: TIMEOUT_MS }).catch(() => expect(false, 'the address does not keep what is hidden'));
	expect((await entry.getAttribute('aria-pressed')) === 'false' && (await imageOf(plot)) !== before, 'the legend does not hide a line');
	await entry.press('Enter');
	await page.waitForURL((url) => !url.searchParams.has('off'), { timeout: TIMEOUT_MS }).catch(() => expect(false, 'the legend does not show a line again by key'));
	const figure = page.locator('[data-figure]', { has: page.getByRole('button', { pressed: true }) }).first();
	const drawn = () => figure.locator('svg path').count();
	const paths = await drawn();
	await figure.getByRole('button', { pressed: true }).first().click();
	await figure.getByRole('button', { pressed: false }).waitFor({ timeout: TIMEOUT_MS });
	expect((await drawn()) < paths, 'the legend of a result figure hides nothing');
	await figure.getByRole('button', { pressed: false }).first().press('Enter');
}

/** Opens a step and a journal entry. Both show their time in the plots. */
export async function goToSteps(page) {
	const viewOf = () => new URL(page.url()).searchParams.get('view');
	const step = page.getByRole('list', { name: 'Steps of the run' }).getByRole('button').nth(1);
	await step.click({ timeout: TIMEOUT_MS });
	await page.waitForURL(/view=-?[\d.]+:/, { timeout: TIMEOUT_MS }).catch(() => expect(false, 'a step does not lead to its time'));
	const atStep = viewOf();
	await page.getByRole('list', { name: 'Journal' }).getByRole('button').first().click();
	await page.waitForURL((url) => url.searchParams.get('view') !== atStep, { timeout: TIMEOUT_MS }).catch(() => expect(false, 'an entry of the journal does not lead to its time'));
	await page.keyboard.press('0');
	await page.waitForURL((url) => !url.searchParams.has('view'), { timeout: TIMEOUT_MS });
}

/** Derives a channel by a formula (once with an error), plots one channel over another, and shows a spectrum. A new page must show the same from the address. */
export async function analyse(page) {
	const panel = page.locator('section', { has: page.getByRole('heading', { name: 'Analysis' }) });
	await panel.getByRole('button', { name: 'Derived channel' }).click();
	const formula = panel.getByRole('combobox', { name: 'Derived channel' });
	await formula.fill('motor_currant_a * 2');
	await formula.press('Enter');
	await panel.getByText('did you mean motor_current_a?').waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'a mistake in a derived channel is not named'));
	await panel.getByRole('button', { name: 'Remove' }).click();
	await formula.fill('drive power [W] = smooth(motor_current_a, 0.02) * 0.064 * motor_velocity_rad_s');
	await formula.press('Enter');
	await panel.getByRole('button', { name: 'Add derivative' }).click();
	const plots = panel.locator('figure:has(.uplot)');
	await plots.nth(1).waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'derived channels are not drawn'));
	expect(/drive power/.test(await plots.first().innerText()), 'a derived channel does not have its name');
	await panel.getByRole('button', { name: 'X–Y' }).click();
	await panel.getByRole('region', { name: 'X–Y' }).locator('.uplot').waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'no channel is drawn over another'));
	await panel.getByLabel(/^Y/).selectOption({ label: 'drive power' });
	await panel.getByRole('button', { name: 'Spectrum' }).click();
	await panel.getByText(/Hann windows?, resolution/).waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'no spectrum is shown'));
	await audit(page, 'the analysis of a run');
	await page.reload();
	await plots.nth(3).waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, `the address does not keep the analysis: ${page.url()}`));
	const wide = await page.evaluate(() => document.documentElement.scrollWidth);
	expect(wide <= 1440, `the analysis is too wide for its page: ${wide} px`);
}

/** Compares two channels of the runs at once. */
export async function compareChannels(page) {
	const channels = page.getByRole('list', { name: 'Channels' });
	await channels.getByLabel('motor velocity').check({ timeout: TIMEOUT_MS });
	await page.waitForURL(/channel=[^&]*,motor_velocity_rad_s/, { timeout: TIMEOUT_MS }).catch(() => expect(false, `the address does not keep both channels: ${page.url()}`));
	await page.locator('#compare .uplot').nth(1).waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'the second channel is not drawn'));
	await channels.getByLabel('motor velocity').uncheck();
}

/** Shows a quantity over all runs of a search, by run and by temperature. */
export async function followTrend(page, base) {
	await page.goto(`${base}/runs?search=procedure:friction`);
	await page.getByRole('button', { name: 'Trend', exact: true }).click();
	const panel = page.locator('#trend');
	await panel.locator('[data-figure]').waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'no trend over runs is drawn'));
	await panel.getByLabel(/^quantity/).selectOption({ value: 'tau_c' });
	await panel.locator('[data-figure=trend-tau_c]').waitFor({ timeout: TIMEOUT_MS });
	await panel.getByLabel(/^over/).selectOption('temperature');
	await page.waitForURL(/over=temperature/);
	await panel.getByText('mean temperature [°C]').waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'the trend is not drawn over the temperature'));
	await audit(page, 'the trend over runs');
	await panel.getByRole('button', { name: 'Close' }).click();
	await panel.waitFor({ state: 'detached' });
}

/** Colours the residual map by its values on a linear scale. */
export async function changeMapColours(page) {
	const section = page.locator('section', { has: page.getByRole('heading', { name: 'Where the model is wrong' }) });
	const fills = () => section.getByRole('application').locator('path').evaluateAll((cells) => cells.map((cell) => cell.getAttribute('fill')).join());
	const before = await fills();
	await section.getByLabel(/^colour/).selectOption('value');
	await section.getByLabel(/^scale/).selectOption('linear');
	await page.waitForURL(/shade=value-linear/, { timeout: TIMEOUT_MS }).catch(() => expect(false, 'the address does not keep the colours of the map'));
	expect((await fills()) !== before, 'the colours of the map do not change with their scale');
	await section.getByLabel(/^colour/).selectOption('errors');
	await section.getByLabel(/^scale/).selectOption('log');
}

/** Opens the joint regions of correlated parameters, if there are any. */
export async function openTradeOffs(page) {
	const summary = page.getByText(/parameter trade-offs?$/);
	if ((await summary.count()) === 0) return console.log('no parameters trade off: their regions are left out');
	await summary.click();
	await page.locator('[data-trade-off] svg').first().waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'the joint region of two parameters is not drawn'));
	await audit(page, 'the parameter trade-offs');
	await summary.click();
}

/** The first answer contains a stop button that works before any script of the dashboard is loaded. */
export async function stopEarly(another, base) {
	const first = await (await fetch(base)).text();
	expect(/id="early-stop"/.test(first), 'the first answer of the daemon has no stop');
	const page = await another();
	await page.route(/\/assets\/.*\.js/, () => {});
	await page.goto(base, { waitUntil: 'commit' });
	await page.getByRole('button', { name: /STOP/ }).click({ timeout: TIMEOUT_MS });
	await page.getByText(/✓ Stopped: /).waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'the stop of the first answer does not stop'));
	await audit(page, 'the frame before the dashboard');
	await page.close();
}
