import { api } from '../api/client';
import { idText } from '../format/label';

/** Titles of the procedures by id, as in the form that starts them. */
class ProcedureTitles {
	private titles: Record<string, string> = $state.raw({ import: 'Import' });
	private isRequested = false;

	/** Requests the titles once; a failed request is repeated with the next contact. */
	async load(): Promise<void> {
		if (this.isRequested) return;
		this.isRequested = true;
		try {
			const procedures = await api.procedures();
			this.titles = { ...this.titles, ...Object.fromEntries(procedures.map(({ id, title }) => [id, title])) };
		} catch {
			this.isRequested = false;
		}
	}

	/** The id in words until the titles are there, and for a procedure that the daemon no longer has. */
	of(id: string): string {
		return this.titles[id] ?? idText(id);
	}
}

export const procedureTitles = new ProcedureTitles();
