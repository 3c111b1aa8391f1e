import type { Exclusion, Model, ResidualSet } from '../api/types';

/** Time ranges that contain the selected points and no others, since the first sample. */
export function excludedStretches(set: ResidualSet, chosen: Uint8Array, each_s: number): { from_s: number; to_s: number; points: number }[] {
	const time = set.axes.find((axis) => axis.name === 'time_s')?.values ?? [];
	const order = time.map((_, i) => i).sort((a, b) => time[a]! - time[b]!);
	const stretches: { from_s: number; to_s: number; points: number }[] = [];
	let joined = false;
	for (const i of order) {
		if (!chosen[i]) {
			joined = false;
			continue;
		}
		const [from_s, to_s] = [Math.max(0, time[i]! - each_s / 2), time[i]! + each_s / 2];
		const last = stretches.at(-1);
		if (joined && last && from_s - last.to_s < each_s) Object.assign(last, { to_s, points: last.points + 1 });
		else stretches.push({ from_s, to_s, points: 1 });
		joined = true;
	}
	return stretches;
}

/** Duration of the run that one point represents. */
export function pointLength_s({ fit: { preparation } }: Model): number {
	return preparation.chunk_s ?? preparation.decimation / preparation.sample_rate_hz;
}

export interface ExclusionReason {
	reason: string;
	stretches: number;
	seconds: number;
}

/** The exclusions, grouped by reason. */
export function exclusionReasons(excluded: readonly Exclusion[]): ExclusionReason[] {
	const all = new Map<string, ExclusionReason>();
	for (const { reason, from_s, to_s } of excluded) {
		const { stretches, seconds } = all.get(reason) ?? { stretches: 0, seconds: 0 };
		all.set(reason, { reason, stretches: stretches + 1, seconds: seconds + to_s - from_s });
	}
	return [...all.values()];
}
