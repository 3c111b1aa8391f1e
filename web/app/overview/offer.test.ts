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
	const bench = (role: string) => ({ instruments: [{ role }] }) as Bench;
	const told = (role: string) => offers(procedures, bench(role)).map((one) => [one.title, one.procedures.map(({ id }) => id).join()]);
	expect(told('joint')).toEqual([
		['friction', 'friction,strokes'],
		['brake', 'brake_hysteresis'],
		['encoder: this bench has no test encoder', 'encoder_delay'],
	]);
	expect(told('test_encoder')[0]).toEqual(['encoder', 'encoder_delay']);
});
