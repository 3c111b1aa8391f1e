import type { Model, Suggestion, EffectAblation } from '../api/types';
import { idText } from '../format/label';
import { sameData, stepName } from './versionTree';

export interface Bar {
	key: string;
	label: string;
	/** Validation RMS. */
	validation: number;
	/** Training RMS; unknown for a predicted bar. */
	training: number | null;
	/** Relative change of the validation RMS from the bar before; `null` if that is of other data. */
	change: number | null;
	id: number | null;
}

/** One bar per version of the path, and a last one for the suggested effect. */
export function barsOf(path: readonly Model[], next: Pick<Suggestion, 'effect' | 'validation_rms'> | null, titleOf = idText): Bar[] {
	const bars: Bar[] = path.map((model, i) => {
		const before = path[i - 1];
		return {
			key: `v${model.id}`,
			label: stepName(model, before, titleOf),
			validation: model.validation_rms,
			training: model.rms,
			change: before && sameData(before, model) ? model.validation_rms / before.validation_rms - 1 : null,
			id: model.id,
		};
	});
	if (next) {
		const before = path.at(-1)?.validation_rms;
		const change = before ? next.validation_rms / before - 1 : null;
		bars.push({ key: 'next', label: `+ ${titleOf(next.effect)}?`, validation: next.validation_rms, training: null, change, id: null });
	}
	return bars;
}

/** Validation error without an effect, with the others fitted again. */
export interface EffectLoss {
	effect: string;
	without: number;
}

/** The largest loss first; an effect without which the fit is impossible has no value. */
export function effectLosses(ablations: readonly EffectAblation[]): EffectLoss[] {
	return ablations.flatMap(({ effect, without_rms }) => (without_rms == null ? [] : [{ effect, without: without_rms }])).sort((a, b) => b.without - a.without);
}

/** Position of the mark of a bar with one added effect: the error without this effect in the current model. */
export function lossMark(added: readonly string[], losses: readonly EffectLoss[]): number | null {
	return added.length === 1 ? (losses.find((one) => one.effect === added[0])?.without ?? null) : null;
}

export function axisTop(bars: readonly Bar[], floor: number | null): number {
	const highest = Math.max(1e-12, floor ?? 0, ...bars.flatMap((bar) => [bar.validation, bar.training ?? 0]));
	return highest * 1.18;
}
