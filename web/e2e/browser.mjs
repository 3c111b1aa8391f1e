// One Chromium page that keeps a record of everything that must not happen.
import { existsSync } from 'node:fs';
import { chromium } from 'playwright-core';

const KNOWN = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];

/** How long the walk waits for what has to come: a page, an answer, a commit of the daemon on a busy machine. */
export const TIMEOUT_MS = 60_000;

export class Failed extends Error {}

export function expect(truth, message) {
	if (!truth) throw new Failed(message);
}

/** Base address of the daemon and the browser, from the arguments or the environment. */
export function settings(usage) {
	const [base, given] = process.argv.slice(2);
	const executablePath = given ?? process.env.JB_CHROMIUM ?? KNOWN.find((path) => existsSync(path));
	if (!base || !executablePath) {
		console.error(`${usage}\nChromium is looked for in ${KNOWN.join(', ')}, $JB_CHROMIUM or the second argument.`);
		process.exit(2);
	}
	return { base: base.replace(/\/$/, ''), executablePath };
}

/** A page at `base`, a way to `another` (elsewhere, with a record of its own, where it says so) in a browser of its own, and the list of what went wrong: console errors, exceptions, requests to another host. */
export async function open({ base, executablePath }, context = {}) {
	const browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--disable-dev-shm-usage'] });
	const faults = [];
	const watched = async (at = base, record = faults) => watch(await (await browser.newContext({ viewport: { width: 1440, height: 900 }, ...context })).newPage(), at, record);
	return { browser, page: await watched(), faults, another: watched };
}

function watch(page, base, faults) {
	page.on('console', (message) => {
		// Chromium calls every refusal an error; that an empty file and a misspelt formula are refused is what is looked for.
		if (/\/runs\/(import(\/preview)?$|\d+\/derived\?formulas=motor_currant)/.test(message.location().url) && /status of 422/.test(message.text())) return;
		if (message.type() === 'error') faults.push(`console: ${message.text()} (${message.location().url})`);
	});
	page.on('pageerror', (error) => faults.push(`exception on ${page.url()}: ${error.stack ?? error.message}`));
	page.on('request', (request) => {
		if (new URL(request.url()).host !== new URL(base).host) faults.push(`request off the host: ${request.url()}`);
	});
	page.on('websocket', (socket) => {
		if (new URL(socket.url()).host !== new URL(base).host) faults.push(`socket off the host: ${socket.url()}`);
	});
	return page;
}

/** Runs the story; says in one line how it ended. */
export async function runStory(name, story) {
	try {
		await story();
		console.log(`${name}: ok`);
		process.exit(0);
	} catch (error) {
		console.error(`${name}: ${error instanceof Failed ? error.message : (error.stack ?? error)}`);
		process.exit(1);
	}
}
