// One Chromium page. It records every event that must not occur.
import { existsSync } from 'node:fs';
import { chromium } from 'playwright-core';

const KNOWN = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];

/** Longest wait for a page, an answer, or a commit of the daemon on a busy machine. */
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

/**
 * Opens a page at `base`. `another` opens a page in a separate browser context, optionally at another address and with a separate record.
 * `faults` lists console errors, exceptions, and requests to another host.
 */
export async function open({ base, executablePath }, context = {}) {
	const browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--disable-dev-shm-usage'] });
	const faults = [];
	const watched = async (at = base, record = faults) => watch(await (await browser.newContext({ viewport: { width: 1440, height: 900 }, ...context })).newPage(), at, record);
	return { browser, page: await watched(), faults, another: watched };
}

function watch(page, base, faults) {
	page.on('console', (message) => {
		// Chromium reports every refused request as an error. The tests send an empty file and an invalid formula on purpose.
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

/** Runs the story and prints its result in one line. */
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
