const KEPT = 'jointbench.role';

/**
 * A protection against accidental clicks, stored in the browser: an observer sees everything and can stop, but cannot
 * start or change anything. Access control is the task of the daemon's tokens. A read-only token makes its user an
 * observer.
 */
class Role {
	private chosen = $state(globalThis.localStorage?.getItem(KEPT) === 'observer');
	/** The token is read-only. */
	reads = $state(false);
	observing = $derived(this.reads || this.chosen);

	/** Why nothing can be started or changed. */
	barred = $derived(this.reads ? 'your token only reads: look, and stop' : 'this browser only observes: press o to operate');

	toggle(): void {
		this.chosen = !this.chosen;
		localStorage.setItem(KEPT, this.chosen ? 'observer' : 'operator');
	}
}

export const role = new Role();
