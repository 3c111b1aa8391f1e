// The product's main path in a real browser, against a running daemon:
//   node web/e2e/walk.mjs http://127.0.0.1:8080 [/usr/bin/chromium]
//
// Pages: the empty daemon, contact lost and restored, a run started and watched, its result by keyboard, plots (own zoom, hidden channels,
// steps, derived channels, X–Y, spectrum), tokens, an observer, the log, and results of several procedures.
// Workbench: the recommended run, regions of residuals, the residual map and its file, exclusions, suggestions tried and added, undo,
// comparisons, a version from another client, REST, a user's effect, autopilots, and an effect removed and added again.
// Bench: the queue, the software stop by keyboard, before any script is loaded, and its reset; a result applied to a bench and reverted.
// Runs: searches, sorting, base run, saved views, columns, imports, comparisons, trends, models of several runs, and ten thousand runs.
//
// No page may break a rule of axe. Exits with 1 and a sentence if a check fails.
import { gzipSync } from 'node:zlib';
import { expect, open, settings, runStory } from './browser.mjs';
import { audit } from './audit.mjs';
import { openUnknownVersion, reimportRun, byKeyboard, chooseColumns, dashesOf, saveListView, openManyRuns, openTogether, readResults, showEarlier, exportRun, exportMap, countCurves, validateOnRun, zoomWhileFollowing } from './checks.mjs';
import { FOREIGN, chooseCurve, importForeign, omitBadRow, omitWrongLines } from './files.mjs';
import { analyse, compareChannels, followTrend, goToSteps, hideChannel, openTradeOffs, changeMapColours, stopEarly } from './plots.mjs';
import { useQueue } from './queue.mjs';
import { WITHOUT_LOAD, brush, compareVersions, excludeAndUndo, firstUse, startAndStopAutopilot, runAutopilotToEnd, loseAndRestoreContact, makeRun, measureNext, runningAnimations, observe, openWorkbench, readResult, readVersion, removeAndUndo, resetStopped, showForeign, startRun, stopByKey, waitForOtherVersion, tryAndDrop, watchRun, writeEffect, zoomOnePlot } from './steps.mjs';
import { applyAndGoBack, makeAndRevoke } from './settings.mjs';

const where = settings('usage: node web/e2e/walk.mjs http://127.0.0.1:8080 [path/to/chromium]');
const FIT_MS = 60_000;
/** Without the script for formulas, which is loaded with the first formula. */
const BUNDLE_BYTES = 160_000;
/** The link is where a stopped autopilot left it. A slow brake run stays within its range. */
const SLOW = { speed_rad_s: 0.5 };
/** Short runs with different kinds of results. The last three need a robot arm and an encoder bench. */
const RESULTS = {
	stiffness: { parameters: { load_levels: 4 }, title: /Torsion over torque/i },
	compensation: { parameters: {}, title: /Errors relative to no compensation/i },
	brake_hysteresis: { parameters: { levels: 5, loops: 1, random_turns: 4, dwell_s: 0.8, ...SLOW }, title: /Minor loops/i },
	puma_friction: { parameters: {}, title: /Shunt voltage over speed/i },
	encoder_alignment: { parameters: { halvings: 2, map_positions: 3 }, title: /Usable range/i },
	encoder_linearity: { parameters: { turns: 2 }, title: /Error over the turn/i },
};
const rest = async (path) => {
	const answer = await fetch(`${where.base}/api/v1${path}`);
	expect(answer.ok, `GET ${path} answers ${answer.status}`);
	return answer.json();
};

await runStory('walk', async () => {
	const { browser, page, faults, another } = await open(where);
	const { jumps, policy } = await firstUse(page, where.base);
	expect(jumps < 0.1, `the page jumps while it loads, by ${jumps}`);
	expect(/default-src 'self'|default-src 'none'/.test(policy) && !/unsafe-eval/.test(policy), `the page may load what it likes: ${policy}`);
	console.log(`layout shift of the first page: ${jumps.toFixed(4)}`);
	const watcher = await another();
	await observe(watcher, where.base);
	const without = await loseAndRestoreContact(another, where.base);
	expect(/no contact with the daemon/.test(without), `Start does not say why it waits: ${without}`);
	const run = await startRun(page, where.base, WITHOUT_LOAD);
	await watcher.getByText('RUNNING').first().waitFor({ timeout: 30_000 }).catch(() => expect(false, 'the observer does not see the run'));
	const assets = await page.evaluate(() => performance.getEntriesByType('resource').map((one) => one.name).filter((name) => /\/assets\/(?!MathFormula-)/.test(name)));
	const files = await Promise.all(assets.map(async (name) => gzipSync(Buffer.from(await (await fetch(name)).arrayBuffer()))));
	const bytes = files.reduce((sum, file) => sum + file.length, 0);
	expect(bytes > 0 && bytes <= BUNDLE_BYTES, `scripts and styles are ${bytes} bytes compressed, ${BUNDLE_BYTES} is the most`);
	console.log(`scripts and styles: ${bytes} bytes compressed`);
	const toWorkbench = await watchRun(page);
	const result = await readResult(page);
	expect(result.verdict !== 'failed' && result.quantities > 2 && result.rows > 10, `the result says too little: ${JSON.stringify(result)}`);
	await zoomOnePlot(page);
	await hideChannel(page);
	await goToSteps(page);
	await analyse(page);
	await audit(page, 'the run');
	console.log(`run ${run} is done`);

	await toWorkbench.click();
	const bare = await readVersion(page);
	expect(bare.verdict === 'adequate', `without load nothing can be missing, but the verdict is ${bare.verdict}`);
	const { text: promised, ...first } = await measureNext(page);
	expect(/expected separation/.test(promised), `the card does not say what it expects: ${promised}`);
	expect(first.verdict === 'missing_effect', `with both runs the model should lack an effect, but the verdict is ${first.verdict}`);
	console.log(`held-out error ${first.held}, missing: ${first.effects.join(', ')}`);

	const axes = await countCurves(page);
	expect(axes.curves > 2 && axes.curves === axes.axes, `not every axis has its curve: ${JSON.stringify(axes)}`);
	const region = page.locator('a.region').first();
	expect((await region.count()) === 1, 'no sentence says where the model fails');
	await region.click();
	await page.waitForURL(/region=/);
	await page.locator('a.region[aria-current=true]').waitFor({ timeout: 30_000 }).catch(() => expect(false, 'the region is not marked'));

	await page.keyboard.press('c');
	const chosen = await brush(page);
	expect(chosen > 0, 'the brush chose no sample');
	expect((await page.locator('svg line[stroke="var(--oi-purple)"]').count()) > 0, 'the chosen samples are not marked along the axes');
	const cell = await byKeyboard(page);
	expect(/standard errors|too few|not measured/.test(cell), `the map does not say what its cell is: ${cell}`);
	await brush(page);
	await changeMapColours(page);
	await openTradeOffs(page);
	const map = await exportMap(page);
	expect(/-map\.parquet$/.test(map.name) && map.begins === 'PAR1', `the map leaves as ${JSON.stringify(map)}`);
	const excluded = await excludeAndUndo(page, 'walked over the cable');
	expect(/without .* s: walked over the cable/.test(excluded), `the page does not say what is excluded: ${excluded}`);

	await page.locator('[data-shape=link_torque_nm]').waitFor({ timeout: 30_000 }).catch(() => expect(false, 'the card does not show what is left over the load, with the shape of the effect on it'));
	const held = await page.evaluate(() => document.querySelector('rect.held.here').dataset.held);
	const text = await tryAndDrop(page);
	await audit(page, 'the workbench');
	expect(/↓ better \(−[\d.]+ ± [\d.]+ %\)/.test(text), `the preview should promise a smaller error, and how sure that is: ${text}`);
	expect((await readVersion(page)).held === Number(held), 'a try must leave the version at hand alone');

	const card = page.locator('article[data-effect]').first();
	const second = await waitForOtherVersion(page, () => card.getByRole('button', { name: 'Add and refit' }).click());
	expect(second.held < first.held, `the error should fall, but went from ${first.held} to ${second.held}`);
	expect((await page.locator('rect.held').count()) >= 2, 'the waterfall has no step');
	console.log(`with ${first.effects[0]}: ${second.held}`);

	const undone = await waitForOtherVersion(page, () => page.keyboard.press('z'));
	expect(undone.held === first.held, `undo should lead back to ${first.held}, but shows ${undone.held}`);

	const differs = await compareVersions(page);
	expect(first.effects[0] === 'load_linear' && differs.includes('Load-dependent friction'), `the comparison does not show what differs: ${differs}`);

	const validated = await validateOnRun(page);
	expect(/RMS error on run #\d+: [\d.]+ [mµ]?Nm/.test(validated), `the validation run gives no error: ${validated}`);

	const back = await showForeign(page, where.base, run, undone, 'viscous_quadratic');
	expect(back.model === undone.model, `back from the version made elsewhere the page shows ${back.model}`);

	const models = await rest(`/models?run=${run}`);
	const [parent, child] = [undone.model, second.model].map((id) => models.find((model) => String(model.id) === id));
	expect(parent && child, `REST does not know the versions ${undone.model} and ${second.model}`);
	expect(child.parent === parent.id && child.added.includes(first.effects[0]), 'REST tells another story of the versions');
	expect(parent.validation_rms === first.held && child.validation_rms === second.held, 'REST has other errors');
	expect(parent.more_runs.join() === String(run + 1) && child.more_runs.join() === String(run + 1), 'REST does not know the second run');
	const [diagnosis] = await rest(`/diagnoses?model=${parent.id}`);
	expect(diagnosis?.suggestions[0]?.effect === first.effects[0], 'REST has another first suggestion');
	expect(diagnosis.where.length > 0, 'REST does not say where the model fails');

	const own = await writeEffect(page, run);
	expect(own.held < first.held, `the own effect should make the error fall, but it went from ${first.held} to ${own.held}`);
	expect((await page.locator('i.forks').count()) > 0, 'the tree of versions does not show where it forks');
	await page.getByRole('button', { name: 'Parity' }).click();
	await page.getByText('model = measured, 95 % band').waitFor({ timeout: 30_000 }).catch(() => expect(false, 'the parity view has no band of the model'));
	await audit(page, 'the own effect');

	const opened = await openWorkbench(another, page.url());
	expect(opened.every((jumps) => jumps < 0.1), `the workbench jumps while it opens, by ${opened.join(' and ')}`);
	console.log(`layout shift of the workbench, desk and phone: ${opened.map((jumps) => jumps.toFixed(4)).join(', ')}`);

	const none = await openUnknownVersion(page, where.base, run);
	expect(/; v\d+ \(model \d+\) is shown/.test(none), `the page does not say which version it shows: ${none}`);
	const ended = await startAndStopAutopilot(page, `${where.base}/workbench/${run}`);
	expect(/stopped by the operator/i.test(ended), `the autopilot does not say where it ended: ${ended}`);
	expect(ended.includes(`from run #${run}`), `the autopilot does not say where it was started: ${ended}`);
	await audit(page, 'the autopilot');
	const autopilot = await runAutopilotToEnd(page, `${where.base}/workbench/${run + 1}`);
	expect(/\b0 runs made/.test(autopilot.text) && autopilot.text.includes(`from run #${run + 1}`), `the autopilot does not say that it made no run: ${autopilot.text}`);
	const { added } = (await rest(`/models?run=${run + 1}`)).find((model) => String(model.id) === autopilot.model);
	expect(added.length > 0, 'the page does not follow the autopilot to the version it ended with');
	const shift = await removeAndUndo(page);
	expect(shift < 0.1, `removing an effect and undoing that makes the page jump, by ${shift}`);
	console.log(`layout shift of removing and undoing: ${shift.toFixed(4)}`);

	for (const path of ['/', '/live', '/log', '/settings']) {
		await page.goto(where.base + path);
		await page.getByRole('heading', { level: 1 }).first().waitFor({ state: 'attached' });
		await audit(page, path);
	}
	await makeAndRevoke(page, another, where.base);
	const moves = await runningAnimations(watcher);
	expect(moves.length === 0, `with little motion asked for these still move: ${moves.join(', ')}`);
	await stopByKey(watcher, where.base, 'observer', ['Control+Shift+Space']);
	expect((await resetStopped(page, where.base)) === 1, 'the stop of the observer does not hold');
	await stopEarly(another, where.base);
	expect((await resetStopped(page, where.base)) > 0, 'the stop of the first answer does not hold');
	await stopByKey(page, where.base, 'operator', ['Escape', 'Escape']);
	expect((await resetStopped(page, where.base)) === 1, 'the stop of the operator does not hold');
	await page.goto(`${where.base}/runs?search=${encodeURIComponent('procedure:fric duration>1s rows>')}`);
	await page.getByRole('link', { name: `#${run}` }).first().waitFor({ timeout: 30_000 });
	await page.getByText(/rows>/).first().waitFor({ timeout: 30_000 }).catch(() => expect(false, 'a half-typed term of a search is not told'));
	await page.getByLabel('Export, views and columns').click();
	await page.getByRole('button', { name: 'CSV of this list' }).click();
	await page.getByText('Nothing is exported').waitFor({ timeout: 30_000 }).catch(() => expect(false, 'a search that is not understood exports another list'));
	const lost = await another(where.base, []);
	await lost.goto(`${where.base}/runs/987654`);
	await lost.getByText('run 987654 does not exist').waitFor({ timeout: 30_000 });
	await audit(lost, 'a run that is not there');
	await lost.close();
	await saveListView(page, where.base, run);
	await chooseColumns(page, where.base, run);
	await chooseCurve(page, where.base);
	await omitBadRow(page, where.base, FOREIGN);
	await omitWrongLines(page, where.base, FOREIGN);
	await importForeign(page, where.base, FOREIGN);
	await page.getByLabel(`Compare run ${run}`).check();
	const third = page.getByLabel(`Compare run ${run + 3}`);
	const stood = (await third.boundingBox()).y;
	await page.getByLabel(`Compare run ${run + 1}`).check();
	await page.locator('.uplot').first().waitFor({ timeout: 30_000 });
	expect((await third.boundingBox()).y === stood, 'a comparison pushes the list away');
	await third.check();
	await page.getByRole('heading', { name: 'Compare 3 runs' }).waitFor({ timeout: 30_000 });
	await page.locator('.uplot').first().waitFor({ timeout: 30_000 });
	await audit(page, 'the comparison');
	await compareChannels(page);

	const beside = await another();
	await zoomWhileFollowing(beside, where.base);
	const { legend, missing, jumps: opening } = await dashesOf(beside, page.url());
	expect(opening < 0.1, `the comparison jumps while it opens, by ${opening}`);
	expect(legend.length === 3 && new Set(legend).size === 3 && missing.length === 0, `colour alone keeps lines apart: ${JSON.stringify({ legend, missing })}`);
	await openTogether(beside, where.base, [run + 1, run]);
	const { rows, jump_ms } = await openManyRuns(beside, where.base);
	expect(rows < 100, `${rows} rows exist of ten thousand runs: only those on the screen should`);
	expect(jump_ms < 2000, `the jump to the last of ten thousand runs takes ${jump_ms} ms`);
	console.log(`ten thousand runs: ${rows} rows, jump to the last ${jump_ms} ms`);

	const again = await makeRun(where.base, 'friction', { load_levels: 1, warm_up_s: 2, dwell_s: 0.6, fast_speeds: 4 });
	await page.goto(`${where.base}/runs/${again}`);
	await page.locator('[data-trend=tau_c]').waitFor({ timeout: FIT_MS }).catch(() => expect(false, 'the result does not stand behind that of the earlier run'));
	await audit(page, 'the result over runs');
	await followTrend(page, where.base);

	const { name, table, report } = await exportRun(page, where.base, run + 1);
	expect(name === `run-${run + 1}.csv` && /^time_s,/.test(table), `the run leaves as ${name}: ${table.slice(0, 60)}`);
	expect(report.includes(`Run ${run + 1}`) && report.includes('SIMULATED'), `the report does not name its run: ${report.slice(0, 200)}`);
	const reimported = await reimportRun(page, where.base, run + 1, table);
	expect(new RegExp(`samples are those of run #${run + 1}: a copy`).test(reimported.text), `a copy is not told: ${reimported.text}`);
	expect(/of a simulated bench/.test(reimported.text), `the copy of a simulated run is not called simulated: ${reimported.text}`);
	expect(/another unit or sign/.test(reimported.text), `a current in milliampere is not told: ${reimported.text}`);
	expect(reimported.verdict === 'contradiction' && reimported.effects.length === 0, `columns contradict each other, but the page says ${reimported.verdict} and offers ${reimported.effects.join(', ')}`);

	const shown = await readResults(page, where.base, RESULTS);
	console.log(`results read: ${shown.join(', ')}`);
	await applyAndGoBack(page, where.base, await makeRun(where.base, 'brake_hysteresis', SLOW));

	const { runs: queued } = await rest(`/runs?search=${await useQueue(page, where.base)}`);
	expect(queued.length === 1, `${queued.length} runs of the queue exist, not one`);

	await showEarlier(page, where.base);

	expect(faults.length === 0, `the page is not clean:\n  ${faults.join('\n  ')}`);
	await browser.close();
});
