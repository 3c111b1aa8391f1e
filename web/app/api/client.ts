import createClient from 'openapi-fetch';
import type { paths } from '../../gen/schema';
import { Refusal, asRefusal } from './problem';
import { authorization } from './token';
import type { EffectDefinition, Exclusion, NewAutopilot } from './types';

export const BASE = '/api/v1';

const client = createClient<paths>({ baseUrl: '' });
client.use({
	onRequest: ({ request }) => {
		for (const [name, value] of Object.entries(authorization())) request.headers.set(name, value);
	},
});

/** The answer's body, or a refusal that a page can show. */
async function body<T>(answer: Promise<{ data?: T; error?: unknown; response: Response }>): Promise<T> {
	try {
		const { data, error, response } = await answer;
		if (data !== undefined) return data;
		if (response.status === 204) return undefined as T;
		const known = typeof error === 'object' && error !== null ? error : { detail: String(error ?? '') };
		throw new Refusal({ title: response.statusText || 'Refused', ...known, status: response.status });
	} catch (failure) {
		if (failure instanceof DOMException && failure.name === 'AbortError') throw failure;
		throw asRefusal(failure);
	}
}

type Signal = AbortSignal | undefined;
type Values = Record<string, unknown>;

/** Every call of the dashboard; each is a documented operation of the REST interface. */
export const api = {
	health: (signal?: Signal) => body(client.GET('/api/v1/health', { signal })),
	benches: (signal?: Signal) => body(client.GET('/api/v1/bench', { signal })),
	acknowledge: (bench: string, reason: string) =>
		body(client.POST('/api/v1/bench/{bench}/acknowledge', { params: { path: { bench } }, body: { reason } })),
	stopBench: (bench: string, signal?: Signal) =>
		body(client.POST('/api/v1/bench/{bench}/stop', { params: { path: { bench } }, signal })),

	/** With what that bench could not make of them, where one is named. */
	procedures: (bench?: string, signal?: Signal) => body(client.GET('/api/v1/procedures', { params: { query: { bench } }, signal })),
	preview: (id: string, bench: string, parameters: Values, signal?: Signal) =>
		body(client.POST('/api/v1/procedures/{id}/preview', { params: { path: { id } }, body: { bench, parameters }, signal })),

	runs: (query: { limit?: number; offset?: number; search?: string }, signal?: Signal) =>
		body(client.GET('/api/v1/runs', { params: { query }, signal })),
	run: (id: number, signal?: Signal) => body(client.GET('/api/v1/runs/{id}', { params: { path: { id } }, signal })),
	identification: (id: number, signal?: Signal) =>
		body(client.GET('/api/v1/runs/{id}/identification', { params: { path: { id } }, signal })),
	start: (bench: string, procedure: string, parameters: Values) =>
		body(client.POST('/api/v1/runs', { body: { bench, procedure, parameters } })),
	control: (id: number, what: 'pause' | 'resume' | 'stop' | 'abort') =>
		body(client.POST(`/api/v1/runs/{id}/${what}`, { params: { path: { id } } })),
	/** Starts a run that makes what this one has left. */
	goOn: (id: number) => body(client.POST('/api/v1/runs/{id}/continue', { params: { path: { id } } })),
	events: (id: number, after?: number, signal?: Signal) =>
		body(client.GET('/api/v1/runs/{id}/events', { params: { path: { id }, query: { after } }, signal })),
	notes: (id: number, signal?: Signal) => body(client.GET('/api/v1/runs/{id}/notes', { params: { path: { id } }, signal })),
	addNote: (id: number, text: string, at_s: number | null) =>
		body(client.POST('/api/v1/runs/{id}/notes', { params: { path: { id } }, body: { text, at_s } })),
	tags: (signal?: Signal) => body(client.GET('/api/v1/tags', { signal })),
	setTags: (id: number, tags: string[]) => body(client.PUT('/api/v1/runs/{id}/tags', { params: { path: { id } }, body: { tags } })),
	samples: (id: number, query: { channels?: string; from_s?: number; to_s?: number; px?: number }, signal?: Signal) =>
		body(client.GET('/api/v1/runs/{id}/samples', { params: { path: { id }, query }, signal })),

	statistics: (id: number, query: { channels?: string; from_s?: number; to_s?: number }, signal?: Signal) =>
		body(client.GET('/api/v1/runs/{id}/statistics', { params: { path: { id }, query }, signal })),

	effects: (kind?: string, signal?: Signal) => body(client.GET('/api/v1/effects', { params: { query: { kind } }, signal })),
	formulas: (kind: string, signal?: Signal) => body(client.GET('/api/v1/formulas/{kind}', { params: { path: { kind } }, signal })),
	checkEffect: (trial: { effect: EffectDefinition; run?: number }, signal?: Signal) =>
		body(client.POST('/api/v1/effects/check', { body: trial, signal })),
	defineEffect: (effect: EffectDefinition) => body(client.POST('/api/v1/effects', { body: effect })),
	forgetEffect: (kind: string, id: string) =>
		body<undefined>(client.DELETE('/api/v1/effects/{kind}/{id}', { params: { path: { kind, id } } })),
	models: (run: number, signal?: Signal) => body(client.GET('/api/v1/models', { params: { query: { run } }, signal })),
	/** Without `exclude` the version looks away where its parent does. */
	fit: (run: number, effects: string[], parent?: { id: number; more_runs: number[] }, exclude?: Exclusion[]) =>
		body(client.POST('/api/v1/models', { body: { run, effects, parent: parent?.id, more_runs: parent?.more_runs, exclude } })),
	worth: (id: number, signal?: Signal) => body(client.GET('/api/v1/models/{id}/worth', { params: { path: { id } }, signal })),
	compare: (first: number, second: number, run: number, signal?: Signal) =>
		body(client.GET('/api/v1/models/{id}/compare/{other}', { params: { path: { id: first, other: second }, query: { run } }, signal })),
	importModel: (run: number, model: Values) => body(client.POST('/api/v1/models/import', { body: { run, model } })),
	residuals: (id: number, signal?: Signal) =>
		body(client.GET('/api/v1/models/{id}/residuals', { params: { path: { id } }, signal })),
	/** The kept diagnosis where nothing has changed since, else a new one. */
	diagnose: (model: number, signal?: Signal) => body(client.POST('/api/v1/diagnoses', { body: { model }, signal })),

	autopilots: (signal?: Signal) => body(client.GET('/api/v1/autopilots', { signal })),
	startAutopilot: (asked: NewAutopilot) => body(client.POST('/api/v1/autopilots', { body: asked })),
	stopAutopilot: (id: number) => body(client.POST('/api/v1/autopilots/{id}/stop', { params: { path: { id } } })),
	experiment: (diagnosis: number, bench: string) =>
		body(client.POST('/api/v1/diagnoses/{id}/experiment', { params: { path: { id: diagnosis } }, body: { bench } })),
};

export const modelHref = (id: number, format: 'json' | 'c' | 'lut' | 'mujoco' | 'urdf') => `${BASE}/models/${id}/export?format=${format}`;

export const reportHref = (run: number) => `${BASE}/runs/${run}/report`;

export function exportHref(run: number, format: 'csv' | 'parquet', stretch: readonly [from_s: number, to_s: number] | null = null): string {
	const part = stretch ? `&from_s=${stretch[0]}&to_s=${stretch[1]}` : '';
	return `${BASE}/runs/${run}/export?format=${format}${part}`;
}
