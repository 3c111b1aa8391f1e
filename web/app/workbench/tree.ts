import type { Model } from '../api/types';
import { words } from '../format/label';

/** From the root of the tree to a version: the story that the waterfall tells. */
export function chain(models: readonly Model[], id: number): Model[] {
	const byId = new Map(models.map((model) => [model.id, model]));
	const path: Model[] = [];
	for (let at = byId.get(id); at && !path.includes(at); at = at.parent == null ? undefined : byId.get(at.parent)) {
		path.unshift(at);
	}
	return path;
}

/** A child on the same data that already holds these effects: going there again needs no new fit. */
export function childWith(models: readonly Model[], parent: Model | null, effects: readonly string[]): Model | undefined {
	const wanted = [...effects].sort().join();
	return models.find(
		(model) =>
			(model.parent ?? null) === (parent?.id ?? null) &&
			(parent ? sameData(parent, model) : model.more_runs.length + model.excluded.length === 0) &&
			[...model.effects].sort().join() === wanted,
	);
}

/** Only errors on the same data can be set against each other. */
export function sameData(one: Model, other: Model): boolean {
	const away = ({ excluded }: Model) => excluded.map(({ from_s, to_s }) => `${from_s}:${to_s}`).join();
	return one.run === other.run && one.more_runs.join() === other.more_runs.join() && away(one) === away(other);
}

/** Only tried, or of next to no gain, and kept by nobody: no page shows it as the run's model. */
export const isAside = ({ tried, idle }: Model): boolean => tried || idle;

/** What a version did to its parent, in a few words. */
export function stepName(model: Model, before?: Model, titleOf = words): string {
	if (model.parent == null) return 'start';
	const parts = [...model.added.map((id) => `+ ${titleOf(id)}`), ...model.removed.map((id) => `− ${titleOf(id)}`)];
	if (parts.length > 0) return parts.join(', ');
	if (before && before.excluded.length !== model.excluded.length) {
		return before.excluded.length < model.excluded.length ? 'without some samples' : 'with samples again';
	}
	return model.more_runs.length > 0 ? `with run ${model.more_runs.join(', ')}` : 'same effects';
}

export interface Branch {
	model: Model;
	depth: number;
	/** The first of a branch that leaves the line to its left. */
	forks: boolean;
	/** Nothing grew from it. */
	ends: boolean;
}

/** All versions, each after its parent. What grew from it first stands aside; the newest goes on straight below, so that a long chain stays flat. */
export function branches(models: readonly Model[]): Branch[] {
	const known = new Set(models.map((model) => model.id));
	const children = new Map<number | null, Model[]>();
	for (const model of models) {
		const parent = model.parent != null && known.has(model.parent) ? model.parent : null;
		children.set(parent, [...(children.get(parent) ?? []), model]);
	}
	const list: Branch[] = [];
	const walk = (parent: number | null, depth: number) => {
		const here = children.get(parent) ?? [];
		for (const model of here) {
			const forks = parent !== null && model !== here.at(-1);
			list.push({ model, depth: depth + Number(forks), forks, ends: !children.has(model.id) });
			walk(model.id, depth + Number(forks));
		}
	};
	walk(null, 0);
	return list;
}

/** What a version's data does not decide: an effect that it added, and any figure that its parent knew. */
export function undecided(before: Model, after: Model): string[] {
	const was = new Map(before.fit.parameters.map((one) => [`${one.effect}.${one.name}`, one.state]));
	const lost = after.fit.parameters.filter((one) => one.state === 'unidentified' && was.get(`${one.effect}.${one.name}`) === 'ok').map((one) => `${one.effect}.${one.name}`);
	const open = after.added.filter((effect) => {
		const own = after.fit.parameters.filter((one) => one.effect === effect);
		return own.length > 0 && own.every((one) => one.state !== 'ok');
	});
	return [...open, ...lost];
}

/** Less than this is no gain. */
export const WORTH = 0.005;

/** `± within`: how far chance alone may take the share. */
export function worded(share: number, within = 0): string {
	const least = Math.max(WORTH, within);
	return share > least ? '↓ better' : share < -least ? '↑ worse' : '≈ no gain';
}

/** Share of the held-out error that a version took away from its parent; negative where it got worse. */
export function gain(before: Model, after: Model): number {
	return before.validation_rms > 0 ? 1 - after.validation_rms / before.validation_rms : 0;
}
