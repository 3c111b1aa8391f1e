import type { Bench, Procedure } from '../api/types';
import { words } from '../format/label';

export interface Offer {
	title: string;
	procedures: Procedure[];
}

/** What each kind of run cannot do without. */
const NEEDS: Record<string, string> = { encoder: 'test_encoder' };

/** Procedures by the kind of run that they bring; what this bench has the instruments for comes first. */
export function offers(procedures: readonly Procedure[], bench: Pick<Bench, 'instruments'>): Offer[] {
	const kinds = [...new Set(procedures.map((one) => one.kind))].map((kind) => {
		const need = NEEDS[kind] ?? 'joint';
		return { kind, need, here: bench.instruments.some((one) => one.role === need) };
	});
	return kinds
		.sort((a, b) => Number(b.here) - Number(a.here))
		.map(({ kind, need, here }) => ({
			title: here ? kind : `${kind}: this bench has no ${words(need)}`,
			procedures: procedures.filter((one) => one.kind === kind),
		}));
}
