import type { Bench, Procedure } from '../api/types';
import { words } from '../format/label';

export interface Offer {
	title: string;
	procedures: Procedure[];
}

/** What each kind of run cannot do without. */
const NEEDS: Record<string, string> = { encoder: 'test_encoder', brake: 'brake' };

/** Procedures by the kind of run that they bring; what this bench has the instruments for comes first, and encoders before all where one is under test. */
export function offers(procedures: readonly Procedure[], bench: Pick<Bench, 'instruments'>): Offer[] {
	const kinds = [...new Set(procedures.map((one) => one.kind))].map((kind) => {
		const need = NEEDS[kind] ?? 'joint';
		const here = bench.instruments.some((one) => one.role === need);
		return { kind, need, here, rank: !here ? 2 : kind === 'encoder' ? 0 : 1 };
	});
	return kinds
		.sort((a, b) => a.rank - b.rank)
		.map(({ kind, need, here }) => ({
			title: here ? kind : `${kind}: this bench has no ${words(need)}`,
			procedures: procedures.filter((one) => one.kind === kind),
		}));
}
