import type { Gesture } from '../plot/gestures';
import { type Route, parseRoute, withQuery } from './route';
import { toggled } from './toggled';

/**
 * A browser accepts 200 changes of the address in ten seconds; a wheel makes more. Only the last change in this time is
 * written.
 */
const REST_MS = 120;
/** After this pause, a wheel movement is a new gesture. */
const PAUSE_MS = 800;
/** Marks an entry in the browser's history that a plot has made. */
const STEP = 'look';

class Router {
	path = $state(location.pathname);
	search = $state(location.search);
	route: Route = $derived(parseRoute(this.path));
	query = $derived(new URLSearchParams(this.search));

	private pendingWrite: ReturnType<typeof setTimeout> | undefined;
	private replaced_ms = Number.NEGATIVE_INFINITY;

	constructor() {
		addEventListener('popstate', () => this.read());
		addEventListener('pagehide', () => this.write());
		document.addEventListener('click', (click) => this.follow(click));
	}

	/** Opens an address of the dashboard. */
	go(address: string, how: 'push' | 'replace' = 'push'): void {
		this.write();
		if (how === 'push') history.pushState(null, '', address);
		else history.replaceState(null, '', address);
		this.read();
	}

	/** Changes settings of the present view. */
	set(changes: Record<string, string | number | null>, how: 'push' | 'replace' = 'replace'): void {
		const next = withQuery(this.query, changes);
		if (next === this.search) return;
		if (how === 'push') return this.go(this.path + next);
		this.search = next;
		const wait_ms = this.replaced_ms + REST_MS - performance.now();
		if (wait_ms <= 0) this.write();
		else this.pendingWrite ??= setTimeout(() => this.write(), wait_ms);
	}

	/** Names in the address, separated by commas. */
	list(key: string): string[] {
		return this.query.get(key)?.split(',').filter(Boolean) ?? [];
	}

	/** Adds a name to a list in the address, or removes it. */
	toggle(key: string, name: string): void {
		this.set({ [key]: toggled(this.list(key), name).join(',') });
	}

	private moved_ms = Number.NEGATIVE_INFINITY;

	/**
	 * Changes the range of a plot. Each gesture is one step in the browser's history, and a double click returns one
	 * step.
	 */
	setRange(changes: Record<string, string | null>, hand: Gesture): void {
		if (hand === 'back' && history.state === STEP) return history.back();
		const goes_on = hand !== 'box' && performance.now() - this.moved_ms < PAUSE_MS;
		this.moved_ms = performance.now();
		if (hand !== 'back' && !goes_on && withQuery(this.query, changes) !== this.search) {
			this.write();
			history.pushState(STEP, '', this.path + this.search);
		}
		this.set(changes);
	}

	/** A double click returns at most to this point. */
	clearRangeHistory(): void {
		this.write();
		history.replaceState(null, '');
	}

	/** Writes the present view to the address. */
	private write(): void {
		clearTimeout(this.pendingWrite);
		this.pendingWrite = undefined;
		if (location.search === this.search || location.pathname !== this.path) return;
		history.replaceState(history.state, '', this.path + this.search);
		this.replaced_ms = performance.now();
	}

	private read(): void {
		clearTimeout(this.pendingWrite);
		this.pendingWrite = undefined;
		const left = this.path;
		this.path = location.pathname;
		this.search = location.search;
		if (left !== this.path) scrollTo(0, 0);
	}

	/** Ordinary links keep all browser functions: new tab, copy address, download. */
	private follow(click: MouseEvent): void {
		if (click.defaultPrevented || click.button !== 0 || click.metaKey || click.ctrlKey || click.shiftKey) return;
		const link = (click.target as Element | null)?.closest?.('a');
		if (!link || link.origin !== location.origin || link.target || link.hasAttribute('download')) return;
		if (link.pathname.startsWith('/api/')) return;
		click.preventDefault();
		this.go(link.pathname + link.search);
	}
}

export const router = new Router();
