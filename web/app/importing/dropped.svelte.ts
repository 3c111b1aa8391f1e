import { router } from '../state/router.svelte';

/** Files that were let fall on whatever page: people miss small targets, and a browser would leave the dashboard for them. */
class Dropped {
	/** Files are held over the page. */
	over = $state(false);
	files: File[] = $state.raw([]);

	hold(event: DragEvent): void {
		if (!event.dataTransfer?.types.includes('Files')) return;
		event.preventDefault();
		this.over = true;
	}

	leave(event: DragEvent): void {
		if (event.relatedTarget === null) this.over = false;
	}

	drop(event: DragEvent): void {
		if (!event.dataTransfer?.types.includes('Files')) return;
		event.preventDefault();
		this.over = false;
		this.files = [...event.dataTransfer.files];
		if (router.route.page !== 'runs') router.go('/runs');
	}

	/** Hands the files over, once. */
	take(): File[] {
		const { files } = this;
		if (files.length) this.files = [];
		return files;
	}
}

export const dropped = new Dropped();
