const KEPT = 'jointbench.role';

/**
 * A lock against stray clicks, kept by the browser: an observer sees everything and can stop, but starts and changes
 * nothing. It is no access control; the daemon's tokens are, and one that only reads makes an observer of whoever has it.
 */
class Role {
	private chosen = $state(globalThis.localStorage?.getItem(KEPT) === 'observer');
	/** The token only reads. */
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
