import { expect, it } from 'vitest';
import type { Bench, Procedure } from '../api/types';
import { offers } from './offer';

it('offers first what the bench has the instruments for', () => {
	const procedures = [
		{ id: 'friction', kind: 'friction' },
		{ id: 'brake_hysteresis', kind: 'brake' },
		{ id: 'encoder_delay', kind: 'encoder' },
		{ id: 'strokes', kind: 'friction' },
	] as Procedure[];
	const bench = (roles: string[]) => ({ instruments: roles.map((role) => ({ role })) }) as Bench;
	const told = (...roles: string[]) => offers(procedures, bench(roles)).map((one) => [one.title, one.procedures.map(({ id }) => id).join()]);
	expect(told('joint', 'brake')).toEqual([
		['friction', 'friction,strokes'],
		['brake', 'brake_hysteresis'],
		['encoder: this bench has no test encoder', 'encoder_delay'],
	]);
	expect(told('joint', 'test_encoder')[0]).toEqual(['encoder', 'encoder_delay']);
	expect(told('joint').at(1)?.[0]).toBe('brake: this bench has no brake current source');
});
