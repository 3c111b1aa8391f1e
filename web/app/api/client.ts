import { callApi } from './request';
import type { EffectDefinition, Exclusion, NewAutopilot, NewModel, NewRun, QueueEntry, Run } from './types';

export const BASE = '/api/v1';

type Signal = AbortSignal | undefined;
type Values = Record<string, unknown>;

/** All calls of the dashboard. Each is a documented operation of the REST interface. */
export const api = {
	archive: (signal?: Signal) => callApi('get', '/api/v1/archive', {}, signal),
	health: (signal?: Signal) => callApi('get', '/api/v1/health', {}, signal),
	benches: (signal?: Signal) => callApi('get', '/api/v1/bench', {}, signal),
	acknowledge: (bench: string, reason: string) =>
		callApi('post', '/api/v1/bench/{bench}/acknowledge', { path: { bench }, body: { reason } }),
	retry: (bench: string) => callApi('post', '/api/v1/bench/{bench}/retry', { path: { bench } }),
	/** Refused while a run is in progress. */
	servoMemory: (bench: string, signal?: Signal) => callApi('get', '/api/v1/bench/{bench}/servo-memory', { path: { bench } }, signal),
	calibrations: (bench: string, signal?: Signal) => callApi('get', '/api/v1/bench/{bench}/calibrations', { path: { bench } }, signal),
	/** The next runs of the bench use the result of this run; `null`: the result of the latest complete run. */
	calibrate: (bench: string, procedure: string, run: number | null) =>
		callApi('post', '/api/v1/bench/{bench}/calibrations', { path: { bench }, body: { procedure, run } }),
	stopBench: (bench: string, signal?: Signal) =>
		callApi('post', '/api/v1/bench/{bench}/stop', { path: { bench } }, signal),

	/** With `bench`: each procedure includes the reason why that bench cannot run it. */
	procedures: (bench?: string, signal?: Signal) => callApi('get', '/api/v1/procedures', { query: { bench } }, signal),
	preview: (id: string, bench: string, parameters: Values, signal?: Signal) =>
		callApi('post', '/api/v1/procedures/{id}/preview', { path: { id }, body: { bench, parameters } }, signal),

	/** Newest first; only for one run, or only for runs before one, if given. */
	log: (query: { run?: number; before?: number }, signal?: Signal) => callApi('get', '/api/v1/log', { query }, signal),
	runs: (query: { limit?: number; offset?: number; search?: string; sort?: string; typing?: boolean }, signal?: Signal) =>
		callApi('get', '/api/v1/runs', { query }, signal),
	run: (id: number, signal?: Signal) => callApi('get', '/api/v1/runs/{id}', { path: { id } }, signal),
	identification: (id: number, signal?: Signal) =>
		callApi('get', '/api/v1/runs/{id}/identification', { path: { id } }, signal),
	earlier: (id: number, signal?: Signal) => callApi('get', '/api/v1/runs/{id}/earlier', { path: { id } }, signal),
	liveComparison: (id: number, signal?: Signal) => callApi('get', '/api/v1/runs/{id}/beside', { path: { id } }, signal),
	/** Results of complete runs. Some may arrive in a later answer. */
	trends: (search: string, signal?: Signal) => callApi('get', '/api/v1/trends', { query: { search } }, signal),
	start: (run: NewRun) => callApi('post', '/api/v1/runs', { body: run }) as Promise<Run>,
	/** The run starts when its bench is free. */
	enqueue: (run: NewRun) => callApi('post', '/api/v1/runs', { body: { ...run, queue: true } }) as Promise<QueueEntry>,
	queues: (signal?: Signal) => callApi('get', '/api/v1/queue', {}, signal),
	restoreToQueue: (id: number) => callApi('post', '/api/v1/queue/{id}/restore', { path: { id } }),
	removeFromQueue: (id: number) => callApi('delete', '/api/v1/queue/{id}', { path: { id } }),
	/** The largest priority starts first. */
	prioritise: (id: number, priority: number) => callApi('put', '/api/v1/queue/{id}/priority', { path: { id }, body: { priority } }),
	switchQueue: (bench: string, how: 'pause' | 'resume') => callApi('post', `/api/v1/bench/{bench}/queue/${how}`, { path: { bench } }),
	/** Units under test and their first-pass yield. */
	units: (query: { search?: string; typing?: boolean }, signal?: Signal) => callApi('get', '/api/v1/units', { query }, signal),
	/** Individuals chart of a quantity over units. */
	controlChart: (query: { search: string; procedure: string; quantity?: string | undefined }, signal?: Signal) => callApi('get', '/api/v1/units/chart', { query }, signal),
	/** `null` for the first run of a unit. */
	unitChanges: (id: number, signal?: Signal) => callApi('get', '/api/v1/runs/{id}/changes', { path: { id } }, signal),
	control: (id: number, what: 'pause' | 'resume' | 'stop' | 'abort') =>
		callApi('post', `/api/v1/runs/{id}/${what}`, { path: { id } }),
	/** Starts a run with the remaining steps of this run. */
	continueRun: (id: number) => callApi('post', '/api/v1/runs/{id}/continue', { path: { id } }),
	plan: (id: number, signal?: Signal) => callApi('get', '/api/v1/runs/{id}/plan', { path: { id } }, signal),
	events: (id: number, after?: number, signal?: Signal) =>
		callApi('get', '/api/v1/runs/{id}/events', { path: { id }, query: { after } }, signal),
	notes: (id: number, signal?: Signal) => callApi('get', '/api/v1/runs/{id}/notes', { path: { id } }, signal),
	addNote: (id: number, text: string, at_s: number | null) =>
		callApi('post', '/api/v1/runs/{id}/notes', { path: { id }, body: { text, at_s } }),
	tags: (signal?: Signal) => callApi('get', '/api/v1/tags', {}, signal),
	setUnitReference: (serial: string, reference: boolean) => callApi('put', '/api/v1/units/{serial}/reference', { path: { serial }, body: { reference } }),
	setTags: (id: number, tags: string[]) => callApi('put', '/api/v1/runs/{id}/tags', { path: { id }, body: { tags } }),
	samples: (id: number, query: { channels?: string; from_s?: number; to_s?: number; px?: number }, signal?: Signal) =>
		callApi('get', '/api/v1/runs/{id}/samples', { path: { id }, query }, signal),

	statistics: (id: number, query: { channels?: string; from_s?: number; to_s?: number }, signal?: Signal) =>
		callApi('get', '/api/v1/runs/{id}/statistics', { path: { id }, query }, signal),

	/** Channels by formulas over the columns of the run: a view `px` wide, or at most `rows` unfiltered rows. */
	derived: (id: number, query: { formulas: string; from_s?: number; to_s?: number; px?: number; rows?: number }, signal?: Signal) =>
		callApi('get', '/api/v1/runs/{id}/derived', { path: { id }, query }, signal),
	spectrum: (id: number, query: { formula: string; from_s?: number; to_s?: number }, signal?: Signal) =>
		callApi('get', '/api/v1/runs/{id}/spectrum', { path: { id }, query }, signal),

	differences: (id: number, query: { others: string; channel: string; by?: string; from?: string }, signal?: Signal) =>
		callApi('get', '/api/v1/runs/{id}/differences', { path: { id }, query }, signal),

	effects: (kind?: string, signal?: Signal) => callApi('get', '/api/v1/effects', { query: { kind } }, signal),
	formulas: (kind: string, signal?: Signal) => callApi('get', '/api/v1/formulas/{kind}', { path: { kind } }, signal),
	checkEffect: (trial: { effect: EffectDefinition; run?: number; more_runs?: number[] | undefined; effects?: string[] | undefined; exclude?: Exclusion[]; columns_of?: number; typing?: boolean }, signal?: Signal) =>
		callApi('post', '/api/v1/effects/check', { body: trial }, signal),
	/** The diagnosis of `run` may suggest the effect; other runs opt in. */
	defineEffect: (effect: EffectDefinition, run: number) => callApi('post', '/api/v1/effects', { query: { run }, body: effect }),
	/** Whether the diagnosis of the run may suggest a user's effect. */
	useEffect: (run: number, effect: string, used: boolean) => callApi(used ? 'put' : 'delete', '/api/v1/runs/{id}/effects/{effect}', { path: { id: run, effect } }),
	forgetEffect: (kind: string, id: string) =>
		callApi('delete', '/api/v1/effects/{kind}/{id}', { path: { kind, id } }),
	models: (run: number, signal?: Signal) => callApi('get', '/api/v1/models', { query: { run } }, signal),
	/** Without `exclude` the version has the same exclusions as its parent. */
	fit: (asked: NewModel) => callApi('post', '/api/v1/models', { body: asked }),
	keepModel: (id: number) => callApi('post', '/api/v1/models/{id}/keep', { path: { id } }),
	/** The contribution of the effect to the prediction at each point of the residuals. */
	withEffect: (id: number, effect: string, signal?: Signal) => callApi('get', '/api/v1/models/{id}/with/{effect}', { path: { id, effect } }, signal),
	effectAblation: (id: number, signal?: Signal) => callApi('get', '/api/v1/models/{id}/worth', { path: { id } }, signal),
	/** A version on another run. Nothing is stored. */
	evaluate: (id: number, run: number, signal?: Signal) => callApi('post', '/api/v1/models/{id}/evaluate', { path: { id }, body: { run } }, signal),
	compare: (first: number, second: number, run: number, signal?: Signal) =>
		callApi('get', '/api/v1/models/{id}/compare/{other}', { path: { id: first, other: second }, query: { run } }, signal),
	importModel: (run: number, model: Values) => callApi('post', '/api/v1/models/import', { body: { run, model } }),
	residuals: (id: number, signal?: Signal) =>
		callApi('get', '/api/v1/models/{id}/residuals', { path: { id } }, signal),
	/** The stored diagnosis if nothing has changed since, else a new one. */
	diagnose: (model: number, signal?: Signal) => callApi('post', '/api/v1/diagnoses', { body: { model } }, signal),

	autopilots: (signal?: Signal) => callApi('get', '/api/v1/autopilots', {}, signal),
	tokens: (signal?: Signal) => callApi('get', '/api/v1/tokens', {}, signal),
	makeToken: (name: string, access: 'full' | 'read') => callApi('post', '/api/v1/tokens', { body: { name, access } }),
	revokeToken: (id: number) => callApi('delete', '/api/v1/tokens/{id}', { path: { id } }),

	startAutopilot: (asked: NewAutopilot) => callApi('post', '/api/v1/autopilots', { body: asked }),
	stopAutopilot: (id: number) => callApi('post', '/api/v1/autopilots/{id}/stop', { path: { id } }),
	experiment: (diagnosis: number, bench: string) =>
		callApi('post', '/api/v1/diagnoses/{id}/experiment', { path: { id: diagnosis }, body: { bench } }),
};

export const modelHref = (id: number, format: 'json' | 'c' | 'lut' | 'mujoco' | 'urdf') => `${BASE}/models/${id}/export?format=${format}`;

/** `model`: the version of the report, else the version in use. */
export const reportHref = (run: number, model?: number) => `${BASE}/runs/${run}/report${model ? `?model=${model}` : ''}`;

export function exportHref(run: number, format: 'csv' | 'parquet', stretch: readonly [from_s: number, to_s: number] | null = null): string {
	const part = stretch ? `&from_s=${stretch[0]}&to_s=${stretch[1]}` : '';
	return `${BASE}/runs/${run}/export?format=${format}${part}`;
}
