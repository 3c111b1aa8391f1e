import type { Model, ParameterSetting } from '../api/types';
import { idText } from '../format/label';

/** The versions from the root of the tree to a version, as the waterfall shows them. */
export function pathTo(models: readonly Model[], id: number): Model[] {
	const byId = new Map(models.map((model) => [model.id, model]));
	const path: Model[] = [];
	for (let at = byId.get(id); at && !path.includes(at); at = at.parent == null ? undefined : byId.get(at.parent)) {
		path.unshift(at);
	}
	return path;
}

/** A child on the same data with these effects: displaying it needs no new fit. */
export function childWith(models: readonly Model[], parent: Model | null, effects: readonly string[]): Model | undefined {
	const wanted = [...effects].sort().join();
	return models.find(
		(model) =>
			(model.parent ?? null) === (parent?.id ?? null) &&
			(parent ? sameData(parent, model) : model.more_runs.length + model.excluded.length === 0) &&
			[...model.effects].sort().join() === wanted &&
			settingsKey(settingsOf(model)) === settingsKey(settingsOf(parent).filter(({ effect }) => effects.includes(effect))),
	);
}

/** Only errors on the same data are comparable. */
export function sameData(one: Model, other: Model): boolean {
	const exclusionKey = ({ excluded }: Model) => excluded.map(({ from_s, to_s }) => `${from_s}:${to_s}`).join();
	return one.run === other.run && one.more_runs.join() === other.more_runs.join() && exclusionKey(one) === exclusionKey(other);
}

/** Fixed values, bounds and start values of the parameters of a version. */
export const settingsOf = (model: Model | null): readonly ParameterSetting[] => model?.fit.settings ?? [];

const settingsKey = (settings: readonly ParameterSetting[]): string =>
	settings.map(({ effect, name, fixed, min, max, start }) => [effect, name, fixed, min, max, start].join(' ')).sort().join();

/** Only tried or with almost no gain, and not kept: no page shows it as the model of the run. */
export const isTrial = ({ tried, idle }: Model): boolean => tried || idle;

/** The change from the parent to this version, in a few words. */
export function stepName(model: Model, before?: Model, titleOf = idText): string {
	if (model.parent == null) return 'start';
	const parts = [...model.added.map((id) => `+ ${titleOf(id)}`), ...model.removed.map((id) => `− ${titleOf(id)}`)];
	if (parts.length > 0) return parts.join(', ');
	if (before && before.excluded.length !== model.excluded.length) {
		return before.excluded.length < model.excluded.length ? 'without some samples' : 'with samples again';
	}
	if (before && settingsKey(settingsOf(before)) !== settingsKey(settingsOf(model))) return settingsOf(model).length > 0 ? 'parameters set' : 'parameters free';
	return model.more_runs.length > 0 ? `with run ${model.more_runs.join(', ')}` : 'same effects';
}

export interface Branch {
	model: Model;
	depth: number;
	/** The first version of a branch that separates from the line at its left. */
	forks: boolean;
	/** A version without children. */
	ends: boolean;
}

/**
 * All versions, each after its parent. Older children are on side branches, and the newest continues straight below, so
 * that a long chain stays flat.
 */
export function branches(models: readonly Model[]): Branch[] {
	const known = new Set(models.map((model) => model.id));
	const children = new Map<number | null, Model[]>();
	for (const model of models) {
		const parent = model.parent != null && known.has(model.parent) ? model.parent : null;
		children.set(parent, [...(children.get(parent) ?? []), model]);
	}
	const branchList: Branch[] = [];
	const walk = (parent: number | null, depth: number) => {
		const siblings = children.get(parent) ?? [];
		for (const model of siblings) {
			const forks = parent !== null && model !== siblings.at(-1);
			branchList.push({ model, depth: depth + Number(forks), forks, ends: !children.has(model.id) });
			walk(model.id, depth + Number(forks));
		}
	};
	walk(null, 0);
	return branchList;
}

/**
 * Results that the data of a version does not determine: an added effect, or a parameter that its parent determined.
 */
export function undecided(before: Model, after: Model): string[] {
	const was = new Map(before.fit.parameters.map((one) => [`${one.effect}.${one.name}`, one.state]));
	const lost = after.fit.parameters.filter((one) => one.state === 'unidentified' && was.get(`${one.effect}.${one.name}`) === 'ok').map((one) => `${one.effect}.${one.name}`);
	const open = after.added.filter((effect) => {
		const own = after.fit.parameters.filter((one) => one.effect === effect);
		return own.length > 0 && own.every((one) => one.state !== 'ok');
	});
	return [...open, ...lost];
}

/** A smaller relative gain counts as none. */
export const MIN_GAIN = 0.005;

export type Gain = 'better' | 'worse' | 'none';

/** `± within`: range of the gain by chance alone. */
export function classifyGain(share: number, within = 0): Gain {
	const least = Math.max(MIN_GAIN, within);
	return share > least ? 'better' : share < -least ? 'worse' : 'none';
}

const GAIN_TEXTS: Record<Gain, string> = { better: '↓ better', worse: '↑ worse', none: '≈ no gain' };

export const gainText = (share: number, within = 0): string => GAIN_TEXTS[classifyGain(share, within)];

/** Relative reduction of the validation error from the parent to this version; negative if it increased. */
export function gain(before: Model, after: Model): number {
	return before.validation_rms > 0 ? 1 - after.validation_rms / before.validation_rms : 0;
}
