import { untrack } from 'svelte';
import { api } from '../api/client';
import type { Model } from '../api/types';
import { lab } from '../state/lab.svelte';
import { resource } from '../state/resource.svelte';
import { router } from '../state/router.svelte';
import { type DirectionFilter, foldPositions, withDerivedAxes } from '../residual/points';
import { regionSamples } from '../residual/regionSamples';
import { isOfJoint } from './joint';
import { defaultAxes } from './rankedAxes';
import { readRegion } from './region';
import { RunData } from './runData.svelte';
import { isTrial, settingsOf } from './versionTree';

const residualsOf = async (version: number, signal: AbortSignal) => ({ version, set: foldPositions(withDerivedAxes(await api.residuals(version, signal))) });

/** The version, comparison and samples that the address selects. */
export class VersionView extends RunData {
	private readonly requestedVersion = $derived(router.query.get('model'));
	private readonly named = $derived(this.versions.find((one) => String(one.id) === this.requestedVersion));
	/** A version made elsewhere may be in the address before it is in the list: the list is requested once more. */
	private reloadedFor: string | null = $state(null);
	private readonly isAwaited = $derived(this.requestedVersion !== null && !this.named && (this.requestedVersion !== this.reloadedFor || this.models.loading));
	private former: Model | null = null;
	/** While the version in the address loads, the former version stays; no other version replaces it. */
	readonly model: Model | null = $derived(
		(this.former = this.isAwaited ? this.former : (this.named ?? this.versions.findLast((one) => !isTrial(one)) ?? this.versions.at(-1) ?? null)),
	);
	/** A second version for comparison: an effect under trial, or any version. */
	readonly comparison: Model | null = $derived(this.versions.find((one) => String(one.id) === router.query.get('with') && one.id !== this.model?.id) ?? null);
	/** The comparison version is a trial of an effect on the current version. */
	readonly isTrying = $derived(this.comparison !== null && this.comparison.parent === this.model?.id && isTrial(this.comparison));
	/** The number of a version in the address that this run does not have. */
	readonly unknownVersion = $derived(this.requestedVersion !== null && !this.named && !this.isAwaited ? this.requestedVersion : null);
	/** File names of the current version. */
	readonly filePrefix = $derived(`run-${this.id}-model-${this.model?.id}`);

	readonly residuals = resource(() => this.model?.id ?? null, residualsOf);
	private readonly otherResiduals = resource(() => this.comparison?.id ?? null, residualsOf);
	/** The displayed residuals belong to the displayed version. */
	readonly residualsAreCurrent = $derived(!this.isAwaited && this.residuals.data?.version === this.model?.id);
	readonly side = $derived((router.query.get('side') ?? 'both') as DirectionFilter);
	readonly ramps = $derived(router.query.has('ramps'));
	/** Text first: a zoom changes the address too, and must not cause a new selection. */
	private readonly regionText = $derived(router.query.get('region'));
	readonly region = $derived(readRegion(this.regionText));
	/** The samples of the region, one flag each: the same in every plot. */
	readonly selectedSamples = $derived(this.residuals.data ? regionSamples(this.residuals.data.set, this.region, this.side, this.ramps) : null);
	readonly defaultAxisNames = $derived(this.residuals.data ? defaultAxes(this.residuals.data.set, this.run.data?.kind) : []);

	/** The tests of a diagnosis fit every parameter freely, so that a model with fixed or bounded parameters has none. */
	readonly hasDiagnosis = $derived(settingsOf(this.model).length === 0);
	readonly diagnosis = resource(
		() => (this.model && this.hasDiagnosis ? `${this.model.id} ${lab.effects}` : null),
		(_key, signal) => api.diagnose(this.model?.id ?? 0, signal),
	);
	/** The displayed diagnosis belongs to the displayed version. */
	readonly diagnosisIsCurrent = $derived(!this.isAwaited && this.diagnosis.data?.model_id === this.model?.id);
	/** Suggestions from contradictory columns are not reliable. */
	readonly hasContradictoryColumns = $derived(this.diagnosis.data?.undecided_reason === 'contradictory_columns');
	readonly suggestions = $derived(this.hasContradictoryColumns ? [] : (this.diagnosis.data?.suggestions ?? []));

	/** All data that determines the layout has arrived once. Before that, nothing that it would move is displayed. */
	isLaidOut = $state(false);

	constructor(id: number) {
		super(id);
		$effect(() => {
			const { models, named, requestedVersion, reloadedFor } = this;
			if (models.data && requestedVersion !== null && !named && requestedVersion !== reloadedFor) untrack(() => ((this.reloadedFor = requestedVersion), models.reload()));
		});
		/** Writes the version to the address, so that a version made elsewhere does not replace it. */
		$effect(() => {
			const { model } = this;
			if (model && !router.query.has('model')) untrack(() => router.set({ model: model.id }));
		});
		$effect(() => {
			const awaited = [this.run, this.effects, this.residuals, this.sameKind, ...(this.hasDiagnosis ? [this.diagnosis] : [])];
			this.isLaidOut ||= this.model !== null && awaited.every((one) => one.data ?? one.error) && !this.result.loading;
		});
	}

	/** Residuals of the comparison version, if both versions have the same samples. */
	get comparisonSet() {
		const [current, compared] = [this.residuals.data, this.otherResiduals.data];
		const alike = compared?.version === this.comparison?.id && compared?.set.error.length === current?.set.error.length;
		return this.comparison && alike ? (compared?.set ?? null) : null;
	}

	/** Runs of the same joint that are not in the data of the model. */
	get otherRuns() {
		return this.similarRuns.filter((one) => one.id !== this.id && !this.model?.more_runs.includes(one.id) && isOfJoint(one, this.run.data));
	}
}
