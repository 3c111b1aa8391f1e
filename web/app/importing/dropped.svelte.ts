import { router } from '../state/router.svelte';
import { filesOf } from './unpack';

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
		const entries = [...event.dataTransfer.items].map((item) => item.webkitGetAsEntry()).filter((entry) => entry !== null);
		const files = [...event.dataTransfer.files];
		void this.takeAll(entries, files);
		if (router.route.page !== 'runs') router.go('/runs');
	}

	/** Folders with what is in them; a browser that knows no entries gives the files alone. */
	private async takeAll(entries: FileSystemEntry[], files: File[]): Promise<void> {
		const found = entries.some((entry) => entry.isDirectory) ? (await Promise.all(entries.map(filesOf))).flat() : files;
		this.files = found;
	}

	/** Hands the files over, once. */
	take(): File[] {
		const { files } = this;
		if (files.length) this.files = [];
		return files;
	}
}

export const dropped = new Dropped();
