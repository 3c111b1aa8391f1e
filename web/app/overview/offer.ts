import type { Procedure } from '../api/types';

export interface Offer {
	title: string;
	procedures: Procedure[];
}

const UNAVAILABLE = 'Not available with the default settings';

/** Procedures by the kind of run, encoders first where one is under test; those that the bench refuses stand apart. */
export function offers(procedures: readonly Procedure[]): Offer[] {
	const can = procedures.filter((one) => !one.refused);
	const kinds = [...new Set(can.map((one) => one.kind))].sort((a, b) => Number(b === 'encoder') - Number(a === 'encoder'));
	const refused = procedures.filter((one) => one.refused);
	return [
		...kinds.map((kind) => ({ title: kind, procedures: can.filter((one) => one.kind === kind) })),
		...(refused.length ? [{ title: UNAVAILABLE, procedures: refused }] : []),
	];
}
