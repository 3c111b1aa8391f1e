import type { Procedure } from '../api/types';

export interface ProcedureGroup {
	title: string;
	procedures: Procedure[];
}

const UNAVAILABLE = 'Not available with the default settings';

/**
 * Procedures by kind of run; encoders come first on a bench with an encoder under test. Procedures that the bench
 * refuses are separate.
 */
export function procedureGroups(procedures: readonly Procedure[]): ProcedureGroup[] {
	const can = procedures.filter((one) => !one.refused);
	const kinds = [...new Set(can.map((one) => one.kind))].sort((a, b) => Number(b === 'encoder') - Number(a === 'encoder'));
	const refused = procedures.filter((one) => one.refused);
	return [
		...kinds.map((kind) => ({ title: kind, procedures: can.filter((one) => one.kind === kind) })),
		...(refused.length ? [{ title: UNAVAILABLE, procedures: refused }] : []),
	];
}
