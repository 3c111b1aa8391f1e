import { untrack } from 'svelte';
import { api } from '../api/client';
import { type Refusal, asRefusal } from '../api/problem';
import type { Model, Run } from '../api/types';
import { percent, quantity } from '../format/number';
import { words } from '../format/label';
import { lab } from '../state/lab.svelte';
import { resource } from '../state/resource.svelte';
import { router } from '../state/router.svelte';
import { isFinal } from '../ui/states';
import { childWith, gain } from './tree';

/** Less than this is no gain. */
const WORTH = 0.005;

/** The model of one run, as the workbench works on it. Call while a component is being set up. */
export function openWorkbench(id: number) {
	let busy: string | null = $state(null);
	let notice: { text: string; good: boolean } | null = $state.raw(null);
	let refused: Refusal | null = $state.raw(null);
	let undone: number[] = $state.raw([]);

	const run = resource(
		() => `${id} ${lab.runStates[id] ?? ''} ${lab.line}`,
		(_key, signal) => api.run(id, signal),
	);
	const models = resource(
		() => `${id} ${lab.models} ${lab.line}`,
		(_key, signal) => api.models(id, signal),
	);
	const effects = resource(
		() => run.data?.kind ?? null,
		(kind, signal) => api.effects(kind, signal),
	);
	const versions: Model[] = $derived(models.data ?? []);
	const model: Model | null = $derived(
		versions.find((one) => String(one.id) === router.query.get('model')) ?? versions.at(-1) ?? null,
	);
	const residuals = resource(
		() => model?.id ?? null,
		async (version, signal) => ({ version, set: await api.residuals(version, signal) }),
	);
	const diagnosis = resource(
		() => model?.id ?? null,
		async (version, signal) => (await api.diagnoses(version, signal)).at(-1) ?? (await api.diagnose(version, signal)),
	);

	/** Fits a set of effects and goes there; a set that was fitted before from the same parent is only visited. */
	async function refit(set: string[], parent: Model | null, what: string): Promise<void> {
		if (busy !== null) return;
		const known = childWith(versions, parent?.id ?? null, set);
		if (known) return show(known, parent);
		busy = what;
		refused = null;
		try {
			const made = await api.fit(id, set, parent?.id);
			models.put([...versions.filter((one) => one.id !== made.id), made]);
			show(made, parent);
		} catch (failure) {
			refused = asRefusal(failure);
		}
		busy = null;
	}

	function show(next: Model, parent: Model | null): void {
		router.set({ model: next.id, region: null, side: null }, parent === null ? 'replace' : 'push');
		undone = [];
		notice = parent ? told(parent, next) : null;
	}

	function told(before: Model, after: Model): { text: string; good: boolean } {
		const share = gain(before, after);
		const unit = after.fit.unit;
		const figures = `${quantity(before.validation_rms, unit)} → ${quantity(after.validation_rms, unit)}`;
		if (share > WORTH) return { text: `Held-out error fell by ${percent(share)}: ${figures}.`, good: true };
		const verdict = share < -WORTH ? `The held-out error rose by ${percent(-share, 1)}` : `No gain in the held-out error (${percent(-share, 1)})`;
		return { text: `${verdict}: ${figures}. Undo with z.`, good: false };
	}

	const add = (effect: string) => model && refit([...model.effects, effect], model, `Refitting with ${words(effect)}`);
	const remove = (effect: string) =>
		model && refit(model.effects.filter((one) => one !== effect), model, `Refitting without ${words(effect)}`);
	const begin = (set: string[]) => refit(set, null, 'Fitting the first model');

	/** Back to the version that this one grew from. Nothing is lost: every version keeps its address. */
	function undo(): void {
		if (model?.parent == null) return;
		undone = [...undone, model.id];
		notice = null;
		router.set({ model: model.parent, region: null, side: null }, 'push');
	}

	function redo(): void {
		const next = undone.at(-1);
		if (next === undefined) return;
		undone = undone.slice(0, -1);
		router.set({ model: next, region: null, side: null }, 'push');
	}

	const baseline: string[] = $derived(baselineOf(run.data));
	const fresh = $derived(models.data !== undefined && versions.length === 0 && run.data !== undefined && run.data.rows > 0);
	$effect(() => {
		if (fresh && run.data && isFinal(run.data.state) && baseline.length > 0 && !refused) untrack(() => void begin(baseline));
	});

	return {
		id,
		run,
		models,
		effects,
		residuals,
		diagnosis,
		add,
		remove,
		begin,
		undo,
		redo,
		get versions() {
			return versions;
		},
		get model() {
			return model;
		},
		get baseline() {
			return baseline;
		},
		get busy() {
			return busy;
		},
		get notice() {
			return notice;
		},
		get refused() {
			return refused;
		},
		get canRedo() {
			return undone.length > 0;
		},
		/** The residuals on the screen belong to the version on the screen. */
		get settled() {
			return residuals.data?.version === model?.id;
		},
		/** The diagnosis on the screen belongs to the version on the screen. */
		get diagnosed() {
			return diagnosis.data?.model_id === model?.id;
		},
	};
}

function baselineOf(run: Run | undefined): string[] {
	const given = run?.meta['baseline'];
	return Array.isArray(given) ? given.map(String) : [];
}

export type Bench = ReturnType<typeof openWorkbench>;
