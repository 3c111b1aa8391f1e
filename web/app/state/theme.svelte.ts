export type Theme = 'light' | 'dark';

const dark = matchMedia('(prefers-color-scheme: dark)');
const KEPT = 'jointbench.theme';

/** Follows the system until a person chooses. */
class ThemeState {
	private chosen = $state(localStorage.getItem(KEPT) as Theme | null);
	private system: Theme = $state(dark.matches ? 'dark' : 'light');
	now: Theme = $derived(this.chosen ?? this.system);

	constructor() {
		dark.addEventListener('change', () => (this.system = dark.matches ? 'dark' : 'light'));
	}

	toggle(): void {
		this.chosen = this.now === 'dark' ? 'light' : 'dark';
		localStorage.setItem(KEPT, this.chosen);
	}
}

export const theme = new ThemeState();
