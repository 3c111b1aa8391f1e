// Files that a user drops on a page.
import { expect } from './browser.mjs';

/** A table with other names and units, a text column, semicolons between columns, and decimal commas. */
export const FOREIGN = ['Time [ms];pos_deg;Iq [A];remark', ...Array.from({ length: 200 }, (_, i) => `${i * 4};${i % 90};0,${i % 9};${i ? '' : 'cold'}`)].join('\n');

/** Drops files on a page. Each file is a name and a text. */
export async function dropFiles(page, base, files, path = '/runs') {
	await page.goto(base + path);
	await page.getByRole('heading', { level: 1 }).first().waitFor({ state: 'attached' });
	await page.evaluate((files) => {
		const dataTransfer = new DataTransfer();
		for (const [name, text] of files) dataTransfer.items.add(new File([text], name));
		for (const name of ['dragover', 'drop']) document.body.dispatchEvent(new DragEvent(name, { dataTransfer, bubbles: true, cancelable: true }));
	}, files);
}

/** Drops a table on the page. Returns the form that asks for its columns. */
export async function chooseForeign(page, base, table) {
	await dropFiles(page, base, [['foreign.csv', table]], '/settings');
	const form = page.getByRole('form', { name: /foreign.csv/ });
	await form.waitFor({ timeout: 30_000 });
	return form;
}

/** A text in a column of numbers is marked. It becomes an empty cell by choice, and its row is omitted. */
export async function omitBadRow(page, base, table) {
	const form = await chooseForeign(page, base, table.replace('8;2;0,2;', '8;2;WRONG;'));
	await form.getByText(/WRONG/).first().waitFor({ timeout: 30_000 }).catch(() => expect(false, 'a cell without a number is not marked'));
	await form.getByLabel('Counts as an empty cell').fill('WRONG');
	await page.keyboard.press('Tab');
	await form.getByText('1 cell without a value').waitFor({ timeout: 30_000 }).catch(() => expect(false, 'an empty cell is not counted'));
	await form.getByLabel('Omit rows with empty cells').check();
	await form.getByText('rows omitted for an empty cell: 1').waitFor({ timeout: 30_000 }).catch(() => expect(false, 'a row with an empty cell is not omitted'));
	await form.getByRole('button', { name: 'Cancel' }).click();
	await form.waitFor({ state: 'detached', timeout: 30_000 });
}

/** Rows that are no samples are listed with their lines, and omitted by one button. */
export async function omitWrongLines(page, base, table) {
	const form = await chooseForeign(page, base, table.replace('8;2;0,2;', '8;2;1..2;').replace('16;4;0,4;', '16;4'));
	const rows = form.getByRole('list', { name: 'Rows that cannot be read as samples' }).getByRole('listitem');
	await rows.nth(1).waitFor({ timeout: 30_000 }).catch(() => expect(false, 'the wrong rows are not listed'));
	await form.getByRole('button', { name: 'omit lines 4, 6' }).click();
	await form.getByText('2 rows omitted as asked').waitFor({ timeout: 30_000 }).catch(() => expect(false, 'wrong rows are not omitted'));
	await form.getByRole('button', { name: 'Cancel' }).click();
	await form.waitFor({ state: 'detached', timeout: 30_000 });
}

/** An own reference of friction compensation is planned from a file. */
export async function chooseCurve(page, base) {
	await page.goto(`${base}/?procedure=compensation`);
	const field = page.getByLabel(/^Own reference/);
	await field.waitFor({ state: 'attached', timeout: 30_000 });
	const choose = (text) => field.setInputFiles({ name: 'cycle.csv', mimeType: 'text/csv', buffer: Buffer.from(text) });
	const shown = async (text, what) => page.getByText(text).first().waitFor({ timeout: 30_000 }).catch(() => expect(false, what));
	await choose('t;v\n0;0\n1;fast\n');
	await shown(/^line 3: two numbers are needed/, 'a wrong line of a curve is not named');
	await choose('t;v\n0;0\n1;0,2\n3;-0,2\n4;0\n');
	await shown('4 points', 'the points of a curve are not counted');
	await shown(/^All checks passed/, 'a reference from a file cannot be started');
	await page.getByRole('button', { name: 'Remove' }).last().click();
}

/** Imports the table in three clicks, from the file to the workbench. */
export async function importForeign(page, base, table) {
	const form = await chooseForeign(page, base, table);
	expect(await form.getByRole('button', { name: 'Import' }).isDisabled(), 'a file without torque constant can be imported');
	await form.getByText('torque constant: a number is needed').waitFor({ timeout: 30_000 }).catch(() => expect(false, 'the page does not say what the import lacks'));
	for (const [name, value] of [['torque constant', '0.08'], ['gear ratio', '50'], ['rotor inertia', '4e-5']]) await form.getByLabel(name).fill(value);
	await form.getByRole('button', { name: 'Import' }).click();
	await page.getByRole('link', { name: 'open in the workbench' }).waitFor({ timeout: 30_000 });
}
