const KEPT = 'jointbench.tries';

function read(): number[] {
	try {
		const list: unknown = JSON.parse(localStorage.getItem(KEPT) ?? '[]');
		return Array.isArray(list) ? list.filter((id): id is number => Number.isInteger(id)) : [];
	} catch {
		return [];
	}
}

/**
 * Versions that this browser only tried. The daemon keeps them like every fit; the tree folds them away until a person
 * keeps them.
 */
class Tries {
	ids: number[] = $state.raw(read());

	has(id: number): boolean {
		return this.ids.includes(id);
	}

	put(id: number): void {
		this.write([...this.ids.filter((one) => one !== id), id]);
	}

	keep(id: number): void {
		if (this.has(id)) this.write(this.ids.filter((one) => one !== id));
	}

	private write(ids: number[]): void {
		this.ids = ids;
		localStorage.setItem(KEPT, JSON.stringify(ids));
	}
}

export const tries = new Tries();
