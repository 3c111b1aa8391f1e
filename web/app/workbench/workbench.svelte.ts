import { untrack } from 'svelte';
import { api } from '../api/client';
import { type ApiError, toApiError } from '../api/apiError';
import type { Exclusion, Model, ParameterSetting } from '../api/types';
import { readComparedRuns } from '../runs/comparedRuns';
import { role } from '../state/role.svelte';
import { router } from '../state/router.svelte';
import { reveal } from '../ui/reveal';
import { isFinal } from '../ui/states';
import { type Notice, changeNotice } from './changeNotice';
import { withSetting } from './parameterSettings';
import { childWith, isTrial, settingsOf } from './versionTree';
import { VersionView } from './versionView.svelte';

/** The model of one run in the workbench, and its fits. Create it during component initialization. */
export class Workbench extends VersionView {
	/** What is being fitted. */
	busy: string | null = $state(null);
	error: ApiError | null = $state.raw(null);
	private lastNotice: Notice | null = $state.raw(null);
	private undone: number[] = $state.raw([]);
	readonly canRedo = $derived(this.undone.length > 0);
	/** The last action or trial, else a note that the last step had no gain. */
	readonly notice = $derived(this.isTrying && this.model && this.comparison ? changeNotice(this.model, this.comparison, false) : (this.lastNotice ?? this.stepWithoutGain()));
	private readonly isNew = $derived(this.models.data !== undefined && this.versions.length === 0 && this.run.data !== undefined && this.run.data.rows > 0);

	constructor(id: number) {
		super(id);
		$effect(() => {
			const more = this.additionalRuns();
			const { model } = this;
			if (model && this.busy === null && more.length) untrack(() => this.fitTogether(model, more));
		});
		$effect(() => {
			const { run, baseline } = this;
			if (this.isNew && run.data && isFinal(run.data.state) && baseline.length > 0 && !this.error) untrack(() => void this.fitFirst(baseline));
		});
	}

	async add(effect: string): Promise<void> {
		if (this.model) await this.refit([...this.model.effects, effect], this.model, `Refitting with ${this.titleOf(effect)}`);
	}

	/**
	 * Adds a user's effect. Its formula may have changed under a name that the model already contains, so all effects
	 * are fitted again.
	 */
	async addOwn(effect: string): Promise<void> {
		if (this.model) await this.refit([...new Set([...this.model.effects, effect])], this.model, `Refitting with ${this.titleOf(effect)}`, true);
	}

	async remove(effect: string): Promise<void> {
		if (this.model) await this.refit(this.model.effects.filter((one) => one !== effect), this.model, `Refitting without ${this.titleOf(effect)}`);
	}

	/** Fits with the effect and compares the result with the current version, which stays displayed. */
	async tryEffect(effect: string): Promise<void> {
		const from = this.model;
		if (!from) return;
		const next = await this.version([...from.effects, effect], from, `Trying ${this.titleOf(effect)}`, { tried: true });
		if (next) this.showComparison(next);
	}

	/** Makes the comparison version the current one. */
	keep(): void {
		if (this.comparison && this.model) void this.show(this.comparison, this.model);
	}

	compareWith(version: number | null): void {
		router.set({ with: version }, 'push');
	}

	/** Displays a version that was made meanwhile, starting at its verdict. */
	showNewVersion(version: number, text: string): void {
		this.select(version, 'push');
		this.lastNotice = { text, good: true };
		void reveal('verdict');
	}

	/** Fits again with what is set for one parameter; `null` frees it. The other settings stay. */
	async setParameter(of: Pick<ParameterSetting, 'effect' | 'name'>, setting: ParameterSetting | null): Promise<void> {
		const from = this.model;
		if (!from) return;
		const parameters = withSetting(settingsOf(from), of, setting);
		const what = `${this.titleOf(of.effect)} ${of.name} ${setting ? 'set' : 'free'}`;
		const made = await this.runFit(`Refitting with ${what}`, () => api.fit({ run: this.id, effects: from.effects, parent: from.id, more_runs: from.more_runs, parameters }));
		if (!made) return;
		await this.show(made, from);
		this.lastNotice = { text: `${what}. Undo with z.`, good: true };
	}

	addRun(more: number): Promise<void> {
		return this.refitOn([...this.moreRuns, more], `Fitting run #${more} with the others`);
	}

	removeRun(less: number): Promise<void> {
		return this.refitOn(this.moreRuns.filter((one) => one !== less), `Fitting without run #${less}`);
	}

	exclude(stretches: Exclusion[], reason: string): Promise<void> {
		const excluded = [...(this.model?.excluded ?? []), ...stretches];
		return this.refitOn(this.moreRuns, 'Refitting without the selected samples', excluded, `Fitted without the selected samples (${reason}).`);
	}

	/** Includes the samples again that were excluded for a reason. */
	include(reason: string): Promise<void> {
		const excluded = (this.model?.excluded ?? []).filter((one) => one.reason !== reason);
		return this.refitOn(this.moreRuns, 'Refitting with the samples', excluded, `Fitted with the samples again that were excluded (${reason}).`);
	}

	/** Fits all runs in the address at once. If they cannot be combined, no run gets an unwanted version. */
	async fitFirst(set: string[]): Promise<void> {
		const more = this.additionalRuns();
		router.set({ more: null });
		const made = await this.runFit(more.length ? this.fitText(more) : 'Fitting the first model', () => api.fit({ run: this.id, effects: set, more_runs: more }));
		if (made) await this.show(made, null);
		else router.set({ more: more.join() || null });
	}

	/** Returns to the parent version. Nothing is lost: every version keeps its address. */
	undo(): void {
		if (this.model?.parent == null) return;
		this.undone = [...this.undone, this.model.id];
		this.lastNotice = null;
		this.select(this.model.parent, 'push');
	}

	redo(): void {
		const next = this.undone.at(-1);
		if (next === undefined) return;
		this.undone = this.undone.slice(0, -1);
		this.select(next, 'push');
	}

	private select(version: number, history: 'push' | 'replace'): void {
		router.set({ model: version, with: null, region: null, side: null, zoom: null }, history);
	}

	/** One fit at a time; its result is a version. */
	private async runFit(what: string, fit: () => Promise<Model>): Promise<Model | null> {
		if (this.busy !== null) return null;
		this.busy = what;
		this.error = null;
		try {
			const made = await fit();
			this.models.put([...this.versions.filter((one) => one.id !== made.id), made]);
			return made;
		} catch (failure) {
			this.error = toApiError(failure);
			return null;
		} finally {
			this.busy = null;
		}
	}

	/** A version with these effects. A set that was fitted before from the same parent needs no new fit. */
	private async version(set: string[], parent: Model, what: string, { anew = false, tried = false } = {}): Promise<Model | null> {
		if (this.busy !== null) return null;
		const known = anew ? undefined : childWith(this.versions, parent, set);
		return known ?? this.runFit(what, () => api.fit({ run: this.id, effects: set, parent: parent.id, more_runs: parent.more_runs, tried }));
	}

	private async refit(set: string[], parent: Model, what: string, anew = false): Promise<void> {
		const next = await this.version(set, parent, what, { anew });
		if (!next) return;
		// A version without gain is displayed for comparison; the user keeps or drops it.
		if (next.idle && parent.id === this.model?.id) return this.showComparison(next);
		await this.show(next, parent);
	}

	/** Fits the same effects to other data; without `excluded` it has the same exclusions as this version. */
	private async refitOn(more: number[], what: string, excluded?: Exclusion[], noticeText?: string): Promise<void> {
		const from = this.model;
		const made = from && (await this.runFit(what, () => api.fit({ run: this.id, effects: from.effects, parent: from.id, more_runs: more, exclude: excluded })));
		if (!made) return;
		await this.show(made, from);
		if (noticeText) this.lastNotice = { text: `${noticeText} Undo with z.`, good: true };
	}

	private async show(next: Model, parent: Model | null): Promise<void> {
		if (isTrial(next) && !role.isObserver && !(await this.runFit('Keeping', () => api.keepModel(next.id)))) return;
		this.select(next.id, parent === null ? 'replace' : 'push');
		this.undone = [];
		this.lastNotice = parent ? changeNotice(parent, next) : null;
		if (this.lastNotice?.good === false) void reveal('workbench-status');
	}

	private showComparison(next: Model): void {
		this.compareWith(next.id);
		void reveal('beside');
	}

	private stepWithoutGain(): Notice | null {
		const { model } = this;
		const before = model?.added.length ? this.versions.find((one) => one.id === model.parent) : undefined;
		const change = before && model ? changeNotice(before, model) : null;
		return change?.good ? null : change;
	}

	private get moreRuns(): number[] {
		return this.model?.more_runs ?? [];
	}

	/** Additional runs in the address: used once, afterwards the address names the version. */
	private additionalRuns(): number[] {
		return readComparedRuns(router.query.get('more')).filter((one) => one !== this.id);
	}

	private fitText(more: number[]): string {
		return `Fitting run #${[this.id, ...more].join(' and #')} together`;
	}

	private fitTogether(from: Model, more: number[]): void {
		router.set({ more: null });
		const known = this.versions.find((one) => one.effects.join() === from.effects.join() && one.more_runs.join() === more.join());
		if (known) router.set({ model: known.id });
		else void this.refitOn(more, this.fitText(more));
	}
}
