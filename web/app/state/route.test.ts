import { expect, it } from 'vitest';
import { parseRoute, withQuery } from './route';

it.each([
	['/', 'bench', null],
	['/runs', 'runs', null],
	['/runs/12', 'run', 12],
	['/workbench/3', 'workbench', 3],
	['/workbench', 'workbench', null],
	['/live', 'live', null],
	['/units', 'units', null],
	['/log', 'log', null],
	['/settings', 'settings', null],
	['/settings/1', 'lost', null],
	['/runs/x', 'lost', null],
	['/runs/1/2', 'lost', null],
	['/elsewhere', 'lost', null],
])('%s is %s', (path, page, run) => expect(parseRoute(path)).toEqual({ page, run }));

it('keeps addresses short and readable', () => {
	const query = new URLSearchParams('model=3&region=a%3A1%3A2');
	expect(withQuery(query, { model: null, x: 'time_s' })).toBe('?region=a:1:2&x=time_s');
	expect(withQuery(new URLSearchParams('a=1'), { a: '' })).toBe('');
});
