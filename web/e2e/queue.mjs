// The queue of a bench: runs are added, reordered, removed, and started.
import { audit } from './audit.mjs';
import { expect, TIMEOUT_MS } from './browser.mjs';
import { WITHOUT_LOAD } from './steps.mjs';

/** Queues two runs while the queue is paused, removes one, restores it, removes it again, and resumes. Returns the search of the other one. */
export async function useQueue(page, base) {
	await page.goto(`${base}/${WITHOUT_LOAD}`);
	const [{ name: bench }] = await (await fetch(`${base}/api/v1/bench`)).json();
	const paused = await fetch(`${base}/api/v1/bench/${bench}/queue/pause`, { method: 'POST' });
	expect(paused.ok, `the queue of ${bench} is not paused: ${paused.status}`);
	const serial = page.getByLabel('Unit (serial number)');
	const entries = page.getByRole('list', { name: 'Queue', exact: true }).getByRole('listitem');
	for (const [i, unit] of ['SN-A', 'SN-B'].entries()) {
		await serial.fill(unit);
		await page.getByRole('button', { name: 'Add to queue' }).click({ timeout: TIMEOUT_MS });
		await entries.nth(i).waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, `the run of ${unit} does not wait in the queue`));
	}
	await serial.fill('');
	await entries.nth(1).getByRole('button', { name: 'to the front' }).click();
	await entries.nth(0).getByText('SN-B').waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'a run does not move to the front'));
	await audit(page, 'the queue');
	const left = page.getByRole('list', { name: 'Left the queue' }).getByRole('listitem');
	for (const again of [true, false]) {
		await entries.nth(0).getByRole('button', { name: 'Remove' }).click();
		await left.filter({ hasText: 'SN-B' }).filter({ hasText: 'REMOVED' }).waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'a removed run is not shown with its outcome'));
		await entries.filter({ hasText: 'SN-B' }).waitFor({ state: 'detached', timeout: TIMEOUT_MS }).catch(() => expect(false, 'a removed run still waits'));
		if (!again) break;
		await audit(page, 'a queue with a removed run');
		await left.filter({ hasText: 'SN-B' }).getByRole('button', { name: 'Restore' }).click();
		await entries.nth(0).getByText('SN-B').waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'a removal is not undone'));
	}
	await page.getByRole('button', { name: 'Resume' }).click();
	await page.getByRole('list', { name: 'Queue', exact: true }).waitFor({ state: 'detached', timeout: TIMEOUT_MS }).catch(() => expect(false, 'a resumed queue does not start its run'));
	await left.filter({ hasText: 'SN-A' }).getByRole('link').waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'a started run is not shown with its outcome'));
	return 'unit:SN-A';
}
