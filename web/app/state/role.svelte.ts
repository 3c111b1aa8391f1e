const STORAGE_KEY = 'jointbench.role';

/**
 * A protection against accidental clicks, stored in the browser: an observer sees everything and can stop, but cannot
 * start or change anything. Access control is the task of the daemon's tokens. A read-only token makes its user an
 * observer.
 */
class Role {
	private chosen = $state(globalThis.localStorage?.getItem(STORAGE_KEY) === 'observer');
	/** The token is read-only. */
	isReadOnly = $state(false);
	isObserver = $derived(this.isReadOnly || this.chosen);

	/** Why nothing can be started or changed. */
	observerReason = $derived(this.isReadOnly ? 'Your token has read access only; Stop works' : 'Observer mode: press o to switch to operator');

	toggle(): void {
		this.chosen = !this.chosen;
		localStorage.setItem(STORAGE_KEY, this.chosen ? 'observer' : 'operator');
	}
}

export const role = new Role();
