/** A limits file that the next runs are judged by. The browser keeps it until another one is chosen. */
export interface LimitsFile {
	name: string;
	text: string;
}

const STORAGE_KEY = 'jointbench.limits';

export function loadLimitsFile(storage: Pick<Storage, 'getItem'>): LimitsFile | null {
	try {
		const stored = JSON.parse(storage.getItem(STORAGE_KEY) ?? 'null') as Partial<LimitsFile> | null;
		return typeof stored?.name === 'string' && typeof stored.text === 'string' ? { name: stored.name, text: stored.text } : null;
	} catch {
		// Another version of the dashboard stored something else.
		return null;
	}
}

export function saveLimitsFile(file: LimitsFile | null, storage: Pick<Storage, 'setItem' | 'removeItem'>): void {
	if (file) storage.setItem(STORAGE_KEY, JSON.stringify(file));
	else storage.removeItem(STORAGE_KEY);
}
