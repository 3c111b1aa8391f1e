export type Theme = 'light' | 'dark';

const dark = matchMedia('(prefers-color-scheme: dark)');
const STORAGE_KEY = 'jointbench.theme';

function read(): Theme {
	const chosen = localStorage.getItem(STORAGE_KEY);
	if (chosen === 'light' || chosen === 'dark') return chosen;
	return dark.matches ? 'dark' : 'light';
}

/** Follows the system until the user selects a theme. */
class ThemeState {
	now: Theme = $state(read());

	constructor() {
		document.documentElement.dataset.theme = this.now;
		dark.addEventListener('change', () => this.put(read()));
	}

	toggle(): void {
		const next = this.now === 'dark' ? 'light' : 'dark';
		localStorage.setItem(STORAGE_KEY, next);
		this.put(next);
	}

	/** Changes the style sheet first, because canvases read their colours from it as soon as the state changes. */
	private put(next: Theme): void {
		document.documentElement.dataset.theme = next;
		this.now = next;
	}
}

export const theme = new ThemeState();
