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

/** Imports the table in three clicks, from the file to the workbench. */
export async function importForeign(page, base, table) {
	const form = await chooseForeign(page, base, table);
	expect(await form.getByRole('button', { name: 'Import' }).isDisabled(), 'a file without torque constant can be imported');
	await form.getByText('torque constant: a number is needed').waitFor({ timeout: 30_000 }).catch(() => expect(false, 'the page does not say what the import lacks'));
	for (const [name, value] of [['torque constant', '0.08'], ['gear ratio', '50'], ['rotor inertia', '4e-5']]) await form.getByLabel(name).fill(value);
	await form.getByRole('button', { name: 'Import' }).click();
	await page.getByRole('link', { name: 'open in the workbench' }).waitFor({ timeout: 30_000 });
}
