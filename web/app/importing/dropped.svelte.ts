import { router } from '../state/router.svelte';

/** Files that were let fall on whatever page: people miss small targets, and a browser would leave the dashboard for them. */
class Dropped {
	files: File[] = $state.raw([]);

	/** Files are held over the page. */
	over = $state(false);
	private gone: ReturnType<typeof setTimeout> | undefined;

	hold(event: DragEvent): void {
		if (!event.dataTransfer?.types.includes('Files')) return;
		event.preventDefault();
		// It is told again and again; nothing tells for sure that it has ended.
		this.over = true;
		clearTimeout(this.gone);
		this.gone = setTimeout(() => (this.over = false), 300);
	}

	drop(event: DragEvent): void {
		this.hold(event);
		if (!event.dataTransfer?.files.length) return;
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
