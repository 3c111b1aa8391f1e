import { untrack } from 'svelte';
import { api } from '../api/client';
import { type ApiError, toApiError } from '../api/apiError';
import type { Exclusion, Model, ParameterSetting, Run } from '../api/types';
import { formatChange, formatQuantity } from '../format/number';
import { effectTitle } from '../format/label';
import { parameterSymbol } from '../format/symbol';
import { lab } from '../state/lab.svelte';
import { resource } from '../state/resource.svelte';
import { readComparedRuns } from '../runs/comparedRuns';
import { role } from '../state/role.svelte';
import { router } from '../state/router.svelte';
import { reveal } from '../ui/reveal';
import { isFinal } from '../ui/states';
import { type DirectionFilter, foldPositions, withDerivedAxes } from '../residual/points';
import { regionSamples } from '../residual/regionSamples';
import { isOfJoint } from './joint';
import { defaultAxes } from './rankedAxes';
import { readRegion } from './region';
import { withSetting } from './parameterSettings';
import { MIN_GAIN, childWith, gain, isTrial, sameData, settingsOf, undecided, gainText } from './versionTree';

/** The model of one run in the workbench. Call during component initialization. */
export function openWorkbench(id: number) {
	let busy: string | null = $state(null);
	let notice: { text: string; good: boolean } | null = $state.raw(null);
	let error: ApiError | null = $state.raw(null);
	let undone: number[] = $state.raw([]);

	const run = resource(
		() => `${id} ${lab.runStates[id] ?? ''} ${lab.connected}`,
		(_key, signal) => api.run(id, signal),
	);
	const models = resource(
		() => `${id} ${lab.models} ${lab.connected}`,
		(_key, signal) => api.models(id, signal),
	);
	const effects = resource(
		() => (run.data ? `${run.data.kind} ${lab.effects}` : null),
		(_key, signal) => api.effects(run.data?.kind ?? '', signal),
	);
	/** What the procedure itself has identified. */
	const result = resource(
		() => (run.data?.verdict ? id : null),
		(run, signal) => api.identification(run, signal),
	);
	/** Runs of the same kind. */
	const similarRuns = resource(
		() => (run.data ? `kind:${run.data.kind}` : null),
		(search, signal) => api.runs({ limit: 100, search }, signal),
	);
	const similar = $derived((similarRuns.data?.runs ?? []).filter((one) => one.rows > 0 && one.is_modelled && isFinal(one.state)));
	const versions: Model[] = $derived(models.data ?? []);
	const requestedVersion = $derived(router.query.get('model'));
	const named = $derived(versions.find((one) => String(one.id) === requestedVersion));
	/** A version made elsewhere may be in the address before it is in the list: the list is requested once more. */
	let reloadedFor: string | null = $state(null);
	$effect(() => {
		if (models.data && requestedVersion !== null && !named && requestedVersion !== reloadedFor) untrack(() => ((reloadedFor = requestedVersion), models.reload()));
	});
	const isAwaited = $derived(requestedVersion !== null && !named && (requestedVersion !== reloadedFor || models.loading));
	/** While the version in the address loads, the former version stays; no other version replaces it. */
	let former: Model | null = null;
	const model: Model | null = $derived(
		(former = isAwaited ? former : (named ?? versions.findLast((one) => !isTrial(one)) ?? versions.at(-1) ?? null)),
	);
	/** Writes the version to the address, so that a version made elsewhere does not replace it. */
	$effect(() => {
		if (model && !router.query.has('model')) untrack(() => router.set({ model: model.id }));
	});
	/** A second version for comparison: an effect under trial, or any version. */
	const comparison: Model | null = $derived(
		versions.find((one) => String(one.id) === router.query.get('with') && one.id !== model?.id) ?? null,
	);
	const load = async (version: number, signal: AbortSignal) => ({ version, set: foldPositions(withDerivedAxes(await api.residuals(version, signal))) });
	const residuals = resource(() => model?.id ?? null, load);
	const otherResiduals = resource(() => comparison?.id ?? null, load);
	const side = $derived((router.query.get('side') ?? 'both') as DirectionFilter);
	const ramps = $derived(router.query.has('ramps'));
	/** Text first: a zoom changes the address too, and must not cause a new selection. */
	const regionText = $derived(router.query.get('region'));
	const region = $derived(readRegion(regionText));
	const selectedSamples = $derived(residuals.data ? regionSamples(residuals.data.set, region, side, ramps) : null);
	const defaultAxisNames = $derived(residuals.data ? defaultAxes(residuals.data.set, run.data?.kind) : []);
	/** The tests of a diagnosis fit every parameter freely, so that a model with fixed or bounded parameters has none. */
	const hasDiagnosis = $derived(settingsOf(model).length === 0);
	const diagnosis = resource(
		() => (model && hasDiagnosis ? `${model.id} ${lab.effects}` : null),
		(_key, signal) => api.diagnose(model?.id ?? 0, signal),
	);

	/** All data that determines the layout has arrived once. Before that, nothing that it would move is displayed. */
	let isLaidOut = $state(false);
	$effect(() => {
		const awaited = [run, effects, residuals, similarRuns, ...(hasDiagnosis ? [diagnosis] : [])];
		isLaidOut ||= model !== null && awaited.every((one) => one.data ?? one.error) && !result.loading;
	});

	const isOwn = (effect: string) => effects.data?.some((one) => one.id === effect && one.definition) ?? false;
	/** The symbol of a parameter; a user's effect has the names of its formula. */
	const symbolOf = ({ effect, name }: { effect: string; name: string }) => (isOwn(effect) ? name : parameterSymbol(name));
	const titleOf = (effect: string) => effectTitle(effects.data, effect);

	/** One fit at a time; its result is a version. */
	async function runFit(what: string, fit: () => Promise<Model>): Promise<Model | null> {
		if (busy !== null) return null;
		busy = what;
		error = null;
		try {
			const made = await fit();
			models.put([...versions.filter((one) => one.id !== made.id), made]);
			return made;
		} catch (failure) {
			error = toApiError(failure);
			return null;
		} finally {
			busy = null;
		}
	}

	/** A version with these effects. A set that was fitted before from the same parent needs no new fit. */
	async function version(set: string[], parent: Model, what: string, { anew = false, tried = false } = {}): Promise<Model | null> {
		if (busy !== null) return null;
		const known = anew ? undefined : childWith(versions, parent, set);
		return known ?? runFit(what, () => api.fit({ run: id, effects: set, parent: parent.id, more_runs: parent.more_runs, tried }));
	}

	async function refit(set: string[], parent: Model, what: string, anew = false): Promise<void> {
		const next = await version(set, parent, what, { anew });
		if (!next) return;
		// A version without gain is displayed for comparison; the user keeps or drops it.
		if (next.idle && parent.id === model?.id) return showComparison(next);
		await show(next, parent);
	}

	async function show(next: Model, parent: Model | null): Promise<void> {
		if (isTrial(next) && !role.isObserver && !(await runFit('Keeping', () => api.keepModel(next.id)))) return;
		router.set({ model: next.id, with: null, region: null, side: null, zoom: null }, parent === null ? 'replace' : 'push');
		undone = [];
		notice = parent ? changeNotice(parent, next) : null;
		if (notice?.good === false) void reveal('workbench-status');
	}

	/** Fits with the effect and compares the result with the current version, which stays displayed. */
	async function tryEffect(effect: string): Promise<void> {
		const from = model;
		if (!from) return;
		const next = await version([...from.effects, effect], from, `Trying ${titleOf(effect)}`, { tried: true });
		if (next) showComparison(next);
	}

	function showComparison(next: Model): void {
		compareWith(next.id);
		void reveal('beside');
	}

	/** Displays a version that was made meanwhile, starting at its verdict. */
	function showNewVersion(version: number, text: string): void {
		router.set({ model: version, with: null, region: null, side: null, zoom: null }, 'push');
		notice = { text, good: true };
		void reveal('verdict');
	}

	const compareWith = (version: number | null) => router.set({ with: version }, 'push');

	/**
	 * The change in the words of a comparison. For a trial, only the undetermined results, because the comparison shows
	 * the rest.
	 */
	function changeNotice(before: Model, after: Model, isKept = true): { text: string; good: boolean } | null {
		if (!sameData(before, after)) return null;
		const share = gain(before, after);
		const open = share > MIN_GAIN ? undecided(before, after) : [];
		if (!isKept && open.length === 0) return null;
		const stays = after.added.length === 0 && Math.abs(share) <= MIN_GAIN;
		const [was, is] = [before, after].map((one) => formatQuantity(one.validation_rms, one.fit.unit));
		const errorText = `Validation error ${was} → ${is}: ${stays ? '≈ as before' : gainText(share)} (${formatChange(-share)})`;
		if (open.length > 0) return { text: `${errorText}, but this data does not decide ${open.join(', ')}: ${isKept ? 'undo with z, or ' : ''}give what is searched for a range that the run can show.`, good: false };
		const good = stays || share > MIN_GAIN;
		return { text: `${errorText}.${good ? '' : ' Undo with z.'}`, good };
	}

	const currentNotice = $derived.by(() => {
		const before = model?.added.length ? versions.find((one) => one.id === model.parent) : undefined;
		const change = before && model ? changeNotice(before, model) : null;
		return change?.good ? null : change;
	});
	const isTrying = $derived(comparison !== null && comparison.parent === model?.id && isTrial(comparison));
	/** Suggestions from contradictory columns are not reliable. */
	const hasContradictoryColumns = $derived(diagnosis.data?.undecided_reason === 'contradictory_columns');

	/** Fits the same effects to other data; without `excluded` it has the same exclusions as this version. */
	async function refitOn(more: number[], what: string, excluded?: Exclusion[], noticeText?: string): Promise<void> {
		const from = model;
		const made = from && (await runFit(what, () => api.fit({ run: id, effects: from.effects, parent: from.id, more_runs: more, exclude: excluded })));
		if (!made) return;
		await show(made, from);
		if (noticeText) notice = { text: `${noticeText} Undo with z.`, good: true };
	}
	/** Fits again with what is set for one parameter; `null` frees it. The other settings stay. */
	async function setParameter(of: Pick<ParameterSetting, 'effect' | 'name'>, setting: ParameterSetting | null): Promise<void> {
		const from = model;
		if (!from) return;
		const parameters = withSetting(settingsOf(from), of, setting);
		const what = `${titleOf(of.effect)} ${of.name} ${setting ? 'set' : 'free'}`;
		const made = await runFit(`Refitting with ${what}`, () => api.fit({ run: id, effects: from.effects, parent: from.id, more_runs: from.more_runs, parameters }));
		if (!made) return;
		await show(made, from);
		notice = { text: `${what}. Undo with z.`, good: true };
	}
	const others = $derived(model?.more_runs ?? []);
	/** Additional runs in the address: used once, afterwards the address names the version. */
	const additionalRuns = () => readComparedRuns(router.query.get('more')).filter((one) => one !== id);
	const fitText = (more: number[]) => `Fitting run #${[id, ...more].join(' and #')} together`;
	$effect(() => {
		const more = additionalRuns();
		if (!model || busy !== null || !more.length) return;
		const from = model;
		untrack(() => {
			router.set({ more: null });
			const known = versions.find((one) => one.effects.join() === from.effects.join() && one.more_runs.join() === more.join());
			if (known) router.set({ model: known.id });
			else void refitOn(more, fitText(more));
		});
	});
	const addRun = (more: number) => refitOn([...others, more], `Fitting run #${more} with the others`);
	const removeRun = (less: number) => refitOn(others.filter((one) => one !== less), `Fitting without run #${less}`);
	const refitWithout = (excluded: Exclusion[], what: string, noticeText: string) => refitOn(others, what, excluded, noticeText);
	const exclude = (stretches: Exclusion[], reason: string) =>
		refitWithout([...(model?.excluded ?? []), ...stretches], 'Refitting without the selected samples', `Fitted without the selected samples (${reason}).`);
	/** Includes the samples again that were excluded for a reason. */
	const include = (reason: string) =>
		refitWithout((model?.excluded ?? []).filter((one) => one.reason !== reason), 'Refitting with the samples', `Fitted with the samples again that were excluded (${reason}).`);

	const add = (effect: string) => model && refit([...model.effects, effect], model, `Refitting with ${titleOf(effect)}`);
	/**
	 * Adds a user's effect. Its formula may have changed under a name that the model already contains, so all effects
	 * are fitted again.
	 */
	const addOwn = async (effect: string) =>
		model && refit([...new Set([...model.effects, effect])], model, `Refitting with ${titleOf(effect)}`, true);
	const remove = (effect: string) =>
		model && refit(model.effects.filter((one) => one !== effect), model, `Refitting without ${titleOf(effect)}`);
	/** Fits all runs in the address at once. If they cannot be combined, no run gets an unwanted version. */
	async function fitFirst(set: string[]): Promise<void> {
		const more = additionalRuns();
		router.set({ more: null });
		const made = await runFit(more.length ? fitText(more) : 'Fitting the first model', () => api.fit({ run: id, effects: set, more_runs: more }));
		if (made) await show(made, null);
		else router.set({ more: more.join() || null });
	}

	/** Returns to the parent version. Nothing is lost: every version keeps its address. */
	function undo(): void {
		if (model?.parent == null) return;
		undone = [...undone, model.id];
		notice = null;
		router.set({ model: model.parent, with: null, region: null, side: null, zoom: null }, 'push');
	}

	function redo(): void {
		const next = undone.at(-1);
		if (next === undefined) return;
		undone = undone.slice(0, -1);
		router.set({ model: next, with: null, region: null, side: null, zoom: null }, 'push');
	}

	const baseline: string[] = $derived(baselineOf(run.data));
	const isNew = $derived(models.data !== undefined && versions.length === 0 && run.data !== undefined && run.data.rows > 0);
	$effect(() => {
		if (isNew && run.data && isFinal(run.data.state) && baseline.length > 0 && !error) untrack(() => void fitFirst(baseline));
	});

	return {
		id,
		run,
		models,
		effects,
		titleOf,
		symbolOf,
		residuals,
		diagnosis,
		add,
		addOwn,
		showNewVersion,
		tryEffect,
		compareWith,
		exclude,
		include,
		/** Makes the comparison version the current one. */
		keep: () => comparison && model && void show(comparison, model),
		remove,
		fitFirst,
		addRun,
		removeRun,
		setParameter,
		undo,
		redo,
		/** Quantities that the run itself has identified. */
		get runResult() {
			return result.data?.quantities ?? [];
		},
		get similarRuns() {
			return similar;
		},
		/** Runs of the same joint that are not in the data of the model. */
		get otherRuns() {
			return similar.filter((one) => one.id !== id && !model?.more_runs.includes(one.id) && isOfJoint(one, run.data));
		},
		get versions() {
			return versions;
		},
		get model() {
			return model;
		},
		get comparison() {
			return comparison;
		},
		/** File names of the current version. */
		get filePrefix() {
			return `run-${id}-model-${model?.id}`;
		},
		/** Residuals of the comparison version, if both versions have the same samples. */
		get comparisonSet() {
			const [current, compared] = [residuals.data, otherResiduals.data];
			const alike = compared?.version === comparison?.id && compared?.set.error.length === current?.set.error.length;
			return comparison && alike ? (compared?.set ?? null) : null;
		},
		/** The comparison version is a trial of an effect on the current version. */
		get isTrying() {
			return isTrying;
		},
		get side() {
			return side;
		},
		get ramps() {
			return ramps;
		},
		get region() {
			return region;
		},
		/** The samples of the region, one flag each: the same in every plot. */
		get selectedSamples() {
			return selectedSamples;
		},
		get baseline() {
			return baseline;
		},
		get busy() {
			return busy;
		},
		get defaultAxisNames() {
			return defaultAxisNames;
		},
		get isLaidOut() {
			return isLaidOut;
		},
		/** The last action or trial, else a note that the last step had no gain. */
		get notice() {
			return isTrying && model && comparison ? changeNotice(model, comparison, false) : (notice ?? currentNotice);
		},
		get error() {
			return error;
		},
		/** The number of a version in the address that this run does not have. */
		get unknownVersion() {
			return requestedVersion !== null && !named && !isAwaited ? requestedVersion : null;
		},
		get hasContradictoryColumns() {
			return hasContradictoryColumns;
		},
		get suggestions() {
			return hasContradictoryColumns ? [] : (diagnosis.data?.suggestions ?? []);
		},
		get canRedo() {
			return undone.length > 0;
		},
		/** The displayed residuals belong to the displayed version. */
		get residualsAreCurrent() {
			return !isAwaited && residuals.data?.version === model?.id;
		},
		get hasDiagnosis() {
			return hasDiagnosis;
		},
		/** The displayed diagnosis belongs to the displayed version. */
		get diagnosisIsCurrent() {
			return !isAwaited && diagnosis.data?.model_id === model?.id;
		},
	};
}

function baselineOf(run: Run | undefined): string[] {
	const given = run?.meta['baseline'];
	return Array.isArray(given) ? given.map(String) : [];
}

export type Workbench = ReturnType<typeof openWorkbench>;
