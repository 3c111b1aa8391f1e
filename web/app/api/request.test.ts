import { afterEach, expect, it, vi } from 'vitest';
import { callApi } from './request';

vi.stubGlobal('sessionStorage', { getItem: () => 'kept' });
afterEach(() => vi.restoreAllMocks());
const answering = (answer: Response) => vi.spyOn(globalThis, 'fetch').mockResolvedValue(answer);

it('fills the places of an address, leaves out what is not asked, and carries the token', async () => {
	const sent = answering(Response.json({ gaps: [] }));
	await callApi('get', '/api/v1/runs/{id}/samples', { path: { id: 7 }, query: { channels: 'a,b', px: undefined } });
	const [href, init] = sent.mock.calls[0]!;
	expect(href).toBe('/api/v1/runs/7/samples?channels=a%2Cb');
	expect(init?.headers).toEqual({ authorization: 'Bearer kept' });
});

it('sends a body as JSON, and knows an answer without one', async () => {
	const sent = answering(new Response(null, { status: 204 }));
	await expect(callApi('put', '/api/v1/runs/{id}/tags', { path: { id: 7 }, body: { tags: ['cold'] } })).resolves.toBeUndefined();
	expect(sent.mock.calls[0]![1]).toMatchObject({ method: 'PUT', body: '{"tags":["cold"]}', headers: { 'content-type': 'application/json' } });
});

it('tells why the daemon refuses, in its own words or those of whoever answers for it', async () => {
	answering(Response.json({ title: 'Not found', detail: 'no run 7' }, { status: 404 }));
	await expect(callApi('get', '/api/v1/runs/{id}', { path: { id: 7 } })).rejects.toMatchObject({ status: 404, title: 'Not found', message: 'no run 7' });
	answering(new Response('the gateway has no backend', { status: 502, statusText: 'Bad Gateway' }));
	await expect(callApi('get', '/api/v1/bench', {})).rejects.toMatchObject({ status: 502, title: 'Bad Gateway', message: 'the gateway has no backend' });
});

it('knows an offline daemon from a question that was taken back', async () => {
	vi.spyOn(globalThis, 'fetch').mockRejectedValueOnce(new TypeError('Failed to fetch'));
	await expect(callApi('get', '/api/v1/bench', {})).rejects.toMatchObject({ offline: true });
	vi.spyOn(globalThis, 'fetch').mockRejectedValueOnce(new DOMException('taken back', 'AbortError'));
	await expect(callApi('get', '/api/v1/bench', {})).rejects.toMatchObject({ name: 'AbortError' });
});
