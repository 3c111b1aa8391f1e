const KEPT = 'jointbench.role';

/**
 * A lock against stray clicks, kept by the browser: an observer sees everything and can stop, but starts and steers
 * nothing. It is no access control; the token is.
 */
class Role {
	observing = $state(localStorage.getItem(KEPT) === 'observer');

	toggle(): void {
		this.observing = !this.observing;
		localStorage.setItem(KEPT, this.observing ? 'observer' : 'operator');
	}
}

export const role = new Role();
