import type { Procedure } from '../api/types';

export interface Offer {
	title: string;
	procedures: Procedure[];
}

/** Procedures by the kind of run that they bring; what the bench can make comes first, and encoders before all where one is under test. */
export function offers(procedures: readonly Procedure[]): Offer[] {
	const kinds = [...new Set(procedures.map((one) => one.kind))].map((kind) => {
		const all = procedures.filter((one) => one.kind === kind);
		const can = all.filter((one) => !one.refused);
		return { kind, here: can.length > 0, rank: can.length === 0 ? 2 : kind === 'encoder' ? 0 : 1, procedures: [...can, ...all.filter((one) => one.refused)] };
	});
	return kinds
		.sort((a, b) => a.rank - b.rank)
		.map(({ kind, here, procedures }) => ({ title: here ? kind : `${kind}: not on this bench`, procedures }));
}
