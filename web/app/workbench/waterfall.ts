import type { Model, Suggestion, Worth } from '../api/types';
import { words } from '../format/label';
import { sameData, stepName } from './tree';

export interface Bar {
	key: string;
	label: string;
	/** Held-out RMS. */
	held: number;
	/** Training RMS; unknown for a bar that is only foreseen. */
	training: number | null;
	/** Change of the held-out RMS against the bar before, as a share; not where that one was held against other data. */
	change: number | null;
	id: number | null;
}

/** One bar for each version on the way, and a last one for the effect that would come next. */
export function barsOf(path: readonly Model[], next: Pick<Suggestion, 'effect' | 'validation_rms'> | null, titleOf = words): Bar[] {
	const bars: Bar[] = path.map((model, i) => {
		const before = path[i - 1];
		return {
			key: `v${model.id}`,
			label: stepName(model, before, titleOf),
			held: model.validation_rms,
			training: model.rms,
			change: before && sameData(before, model) ? model.validation_rms / before.validation_rms - 1 : null,
			id: model.id,
		};
	});
	if (next) {
		const before = path.at(-1)?.validation_rms;
		const change = before ? next.validation_rms / before - 1 : null;
		bars.push({ key: 'next', label: `+ ${titleOf(next.effect)}?`, held: next.validation_rms, training: null, change, id: null });
	}
	return bars;
}

/** What is left when an effect goes and the others are fitted again. */
export interface Loss {
	effect: string;
	without: number;
}

/** The largest loss first; an effect without which nothing can be fitted has no figure. */
export function lossesOf(worth: readonly Worth[]): Loss[] {
	return worth.flatMap(({ effect, without_rms }) => (without_rms == null ? [] : [{ effect, without: without_rms }])).sort((a, b) => b.without - a.without);
}

/** Where the mark of a bar stands that added one effect alone: the error if that went now. */
export function markOf(added: readonly string[], losses: readonly Loss[]): number | null {
	return added.length === 1 ? (losses.find((one) => one.effect === added[0])?.without ?? null) : null;
}

export function topOf(bars: readonly Bar[], floor: number | null): number {
	const highest = Math.max(1e-12, floor ?? 0, ...bars.flatMap((bar) => [bar.held, bar.training ?? 0]));
	return highest * 1.18;
}
