// Settings: access tokens, and the results that the next runs use.
import { audit } from './audit.mjs';
import { expect, TIMEOUT_MS } from './browser.mjs';

/** Creates a read-only token. A page with this token cannot start a run, and is disconnected when the token is revoked. */
export async function makeAndRevoke(page, another, base) {
	await page.goto(`${base}/settings`);
	await page.getByLabel('Name of the token').fill('wall screen');
	await page.getByRole('button', { name: 'Create a token' }).click();
	const secret = await page.getByText('shown this once').locator('code').innerText({ timeout: TIMEOUT_MS });
	await audit(page, 'a token that was made');
	const guest = await another();
	await guest.addInitScript((secret) => sessionStorage.setItem('jointbench.token', secret), secret);
	await guest.goto(`${base}/settings`);
	await guest.getByText('Your token has read access only').first().waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'a token that only reads is not told to its holder'));
	expect((await guest.getByLabel('Name of the token').count()) === 0, 'whoever only reads is asked to make tokens');
	await page.reload();
	const row = page.locator('[data-token="wall screen"]');
	await row.waitFor({ timeout: TIMEOUT_MS });
	const text = await row.innerText();
	expect(/observer/.test(text) && !/never/.test(text), `the token that a page came in with is told so: ${text}`);
	expect((await page.getByText(secret).count()) === 0, 'the secret of a token is shown again');
	await row.getByRole('button', { name: 'Revoke wall screen' }).click();
	await row.getByRole('button', { name: 'Revoke it' }).click();
	await row.waitFor({ state: 'detached', timeout: TIMEOUT_MS });
	await guest.waitForFunction(() => !document.body.innerText.includes('Your token has read access only'), null, { timeout: TIMEOUT_MS }).catch(() => expect(false, 'a page whose token was revoked goes on as if it had one'));
	await guest.close();
}

/** Applies the result of a brake run to its bench, checks the user's name there and in the log, and returns to the last complete run. */
export async function applyAndGoBack(page, base, run) {
	await page.goto(`${base}/runs/${run}`);
	await page.getByText('Apply to bench …').click({ timeout: TIMEOUT_MS });
	expect((await page.getByRole('table', { name: 'What changes on the bench' }).locator('tbody tr').count()) > 2, 'what is applied is not shown before');
	await page.getByRole('button', { name: /^Apply to / }).click();
	await page.getByRole('button', { name: 'The next runs use it' }).click();
	await page.locator(`[data-applied="${run}"]`).waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'the run does not say that it is applied'));
	await page.goto(`${base}/settings`);
	const row = page.locator(`[data-calibration="${run}"]`);
	await row.getByText('holds').waitFor({ timeout: TIMEOUT_MS });
	await audit(page, 'settings with a calibration');
	await page.getByRole('button', { name: 'Take back brake hysteresis' }).click();
	await page.getByRole('button', { name: 'Use the latest complete run' }).click();
	await row.getByRole('button', { name: `Go back to it: run ${run}` }).waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'there is no way back to what was applied'));
	await page.goto(`${base}/log`);
	await page.getByText(`brake_hysteresis of run ${run} applied`).filter({ hasText: '(local)' }).waitFor({ timeout: TIMEOUT_MS }).catch(() => expect(false, 'the log does not show who applied what'));
}
