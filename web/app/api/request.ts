import type { paths } from '../../gen/schema';
import { ApiError, toApiError } from './apiError';
import { tokenRequest } from '../state/tokenRequest.svelte';
import { role } from '../state/role.svelte';
import { authorization } from './token';

type Method = 'get' | 'post' | 'put' | 'delete';
type Operation<P extends keyof paths, M extends Method> = NonNullable<paths[P][M]>;
type Json<T> = T extends { content: { 'application/json': infer Body } } ? Body : undefined;
/** Arguments of a call: path parameters, query, body. */
type Given<O> = (O extends { parameters: infer P } ? Pick<P, keyof P & ('path' | 'query')> : never) & (O extends { requestBody: infer B } ? { body: Json<B> } : unknown);
type Answer<O> = O extends { responses: infer R } ? { [S in keyof R & (200 | 201 | 202 | 204)]: Json<R[S]> }[keyof R & (200 | 201 | 202 | 204)] : never;

interface Loose {
	path?: Record<string, string | number>;
	query?: Record<string, string | number | boolean | undefined>;
	body?: unknown;
}

/** One documented operation of the REST interface, with the types of the API document. */
export async function callApi<P extends keyof paths, M extends Method>(method: M, address: P, given: Given<Operation<P, M>>, signal?: AbortSignal): Promise<Answer<Operation<P, M>>> {
	const { path = {}, query = {}, body } = given as Loose;
	const search = Object.entries(query).flatMap(([name, value]) => (value == null ? [] : [`${name}=${encodeURIComponent(value)}`]));
	const href = [address.replace(/\{(\w+)\}/g, (_all, name: string) => encodeURIComponent(path[name]!)), ...(search.length ? [search.join('&')] : [])].join('?');
	const sent = body === undefined ? {} : { body: JSON.stringify(body), headers: { 'content-type': 'application/json' } };
	const answer = await request(href, { method: method.toUpperCase(), signal: signal ?? null, ...sent });
	return (answer.status === 204 ? undefined : await answer.json()) as Answer<Operation<P, M>>;
}

/** Sends a request with the user's token. Throws a refusal that a page can show. */
export async function request(href: string, { headers, ...rest }: RequestInit = {}): Promise<Response> {
	if (role.isObserver && rest.method && rest.method !== 'GET' && !/\/(stop|preview|check|diagnoses)$/.test(href)) {
		throw new ApiError({ title: 'Not by an observer', detail: role.observerReason, status: 403 });
	}
	try {
		const send = () => fetch(href, { ...rest, headers: { ...headers, ...authorization() } });
		let answer = await send();
		// The request is repeated with the new token. A delayed stop is useless, so a stop is not repeated.
		while (answer.status === 401 && rest.method && rest.method !== 'GET' && !href.endsWith('/stop')) {
			await tokenRequest.request();
			answer = await send();
		}
		if (answer.ok) return answer;
		throw new ApiError({ title: answer.statusText || 'Refused', ...problemOf(await answer.text()), status: answer.status });
	} catch (failure) {
		if (failure instanceof DOMException && failure.name === 'AbortError') throw failure;
		throw toApiError(failure);
	}
}

function problemOf(text: string): object {
	try {
		return JSON.parse(text) as object;
	} catch {
		return { detail: text };
	}
}
