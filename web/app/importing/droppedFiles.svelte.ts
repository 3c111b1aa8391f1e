import { router } from '../state/router.svelte';
import { filesOf } from './unpack';

/**
 * Files that were dropped on any page. Small targets are easy to miss, and a browser would leave the dashboard for a
 * missed file.
 */
class DroppedFiles {
	files: File[] = $state.raw([]);

	/** Files are dragged over the page. */
	over = $state(false);
	private leaveTimer: ReturnType<typeof setTimeout> | undefined;

	hold(event: DragEvent): void {
		if (!event.dataTransfer?.types.includes('Files')) return;
		event.preventDefault();
		// This event repeats while files are dragged, but no event reliably marks the end.
		this.over = true;
		clearTimeout(this.leaveTimer);
		this.leaveTimer = setTimeout(() => (this.over = false), 300);
	}

	drop(event: DragEvent): void {
		this.hold(event);
		if (!event.dataTransfer?.files.length) return;
		const entries = [...event.dataTransfer.items].map((item) => item.webkitGetAsEntry()).filter((entry) => entry !== null);
		const files = [...event.dataTransfer.files];
		void this.takeAll(entries, files);
		if (router.route.page !== 'runs') router.go('/runs');
	}

	/** Folders with their content. A browser without support for entries gives only the files. */
	private async takeAll(entries: FileSystemEntry[], files: File[]): Promise<void> {
		const found = entries.some((entry) => entry.isDirectory) ? (await Promise.all(entries.map(filesOf))).flat() : files;
		this.files = found;
	}

	/** Returns the files once. */
	take(): File[] {
		const { files } = this;
		if (files.length) this.files = [];
		return files;
	}
}

export const droppedFiles = new DroppedFiles();
