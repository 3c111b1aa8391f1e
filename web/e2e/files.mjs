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

/** Imports the table in three clicks, from the file to the workbench. */
export async function importForeign(page, base, table) {
	const form = await chooseForeign(page, base, table);
	expect(await form.getByRole('button', { name: 'Import' }).isDisabled(), 'a file without torque constant can be imported');
	await form.getByText('torque constant: a number is needed').waitFor({ timeout: 30_000 }).catch(() => expect(false, 'the page does not say what the import lacks'));
	for (const [name, value] of [['torque constant', '0.08'], ['gear ratio', '50'], ['rotor inertia', '4e-5']]) await form.getByLabel(name).fill(value);
	await form.getByRole('button', { name: 'Import' }).click();
	await page.getByRole('link', { name: 'open in the workbench' }).waitFor({ timeout: 30_000 });
}
