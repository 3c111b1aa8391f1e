import type { Model, Suggestion } from '../api/types';
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
export function barsOf(path: readonly Model[], next: Pick<Suggestion, 'effect' | 'validation_rms'> | null): Bar[] {
	const bars: Bar[] = path.map((model, i) => {
		const before = path[i - 1];
		return {
			key: `v${model.id}`,
			label: stepName(model),
			held: model.validation_rms,
			training: model.rms,
			change: before && sameData(before, model) ? model.validation_rms / before.validation_rms - 1 : null,
			id: model.id,
		};
	});
	if (next) {
		const before = path.at(-1)?.validation_rms;
		const change = before ? next.validation_rms / before - 1 : null;
		bars.push({ key: 'next', label: `+ ${next.effect.replaceAll('_', ' ')}?`, held: next.validation_rms, training: null, change, id: null });
	}
	return bars;
}

export function topOf(bars: readonly Bar[], floor: number | null): number {
	const highest = Math.max(1e-12, floor ?? 0, ...bars.flatMap((bar) => [bar.held, bar.training ?? 0]));
	return highest * 1.18;
}
