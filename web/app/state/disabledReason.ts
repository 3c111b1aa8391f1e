import type { Bench } from '../api/types';
import { lab } from './lab.svelte';
import { role } from './role.svelte';

/** Why nothing can be started on a bench at present, in words. */
export function disabledReason({ blocked, run }: Bench): string | null {
	if (role.isObserver) return role.observerReason;
	if (lab.contactLost) return 'no contact with the daemon';
	if (blocked) return `the bench is ${blocked.stopped ? 'stopped' : 'blocked'}: inspect it and reset it above`;
	return run ? `run #${run} is in progress` : null;
}
