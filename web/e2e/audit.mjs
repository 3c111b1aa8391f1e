// Accessibility of the displayed page in both themes, by axe-core. It runs through the debugger, so the page's policy stays strict.
import { createRequire } from 'node:module';
import { readFileSync } from 'node:fs';
import { expect, TIMEOUT_MS } from './browser.mjs';

const source = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

/** What is computed again is dimmed: the page is judged when it is done. */
export async function audit(page, name) {
	await page.waitForFunction(() => !document.querySelector('main .old'), null, { timeout: TIMEOUT_MS }).catch(() => expect(false, `${name} is not computed in time`));
	if (!(await page.evaluate('typeof axe === "object"'))) await page.evaluate(source);
	const found = await page.evaluate(async () => {
		const { dataset } = document.documentElement;
		const now = dataset.theme;
		const violations = [];
		for (const theme of ['light', 'dark']) {
			dataset.theme = theme;
			violations.push(...(await axe.run(document, { resultTypes: ['violations'] })).violations.map((one) => ({ ...one, theme })));
		}
		dataset.theme = now;
		return violations.map(({ id, help, nodes, theme }) => `${theme}: ${id}: ${help}; ${nodes.slice(0, 3).map((node) => `${node.html.slice(0, 160)} ${node.any[0]?.message ?? ''}`).join(' | ')}`);
	});
	expect(found.length === 0, `${name} breaks rules of accessibility:\n  ${found.join('\n  ')}`);
}
