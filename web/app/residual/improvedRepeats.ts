import type { ResidualSet } from '../api/types';

/** Number of repeats whose residual an effect would reduce. `null` without repeats. */
export function improvedRepeats({ error, repeat, held_out }: Pick<ResidualSet, 'error' | 'repeat' | 'held_out'>, contribution: readonly number[]): { yes: number; of: number } | null {
	const gain = new Map<number, number>();
	for (let i = 0; i < error.length; i++) {
		if (!held_out[i]) gain.set(repeat[i]!, (gain.get(repeat[i]!) ?? 0) + error[i]! ** 2 - (error[i]! - contribution[i]!) ** 2);
	}
	return gain.size < 2 ? null : { yes: [...gain.values()].filter((one) => one > 0).length, of: gain.size };
}
