import { type Route, parseRoute, withQuery } from './route';

class Router {
	path = $state(location.pathname);
	search = $state(location.search);
	route: Route = $derived(parseRoute(this.path));
	query = $derived(new URLSearchParams(this.search));

	constructor() {
		addEventListener('popstate', () => this.read());
		document.addEventListener('click', (click) => this.follow(click));
	}

	/** Goes to an address of the dashboard. */
	go(address: string, how: 'push' | 'replace' = 'push'): void {
		if (how === 'push') history.pushState(null, '', address);
		else history.replaceState(null, '', address);
		this.read();
	}

	/** Changes how the present view is set. */
	set(changes: Record<string, string | number | null>, how: 'push' | 'replace' = 'replace'): void {
		const next = withQuery(this.query, changes);
		if (next !== this.search) this.go(this.path + next, how);
	}

	private read(): void {
		const left = this.path;
		this.path = location.pathname;
		this.search = location.search;
		if (left !== this.path) scrollTo(0, 0);
	}

	/** Ordinary links stay ordinary links: new tab, copy address, download all work. */
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
