import { expect, it } from 'vitest';
import type { Procedure } from '../api/types';
import { procedureGroups } from './procedureGroups';

it('offers first what the bench can make', () => {
	const offered = (...possible: string[]) => {
		const all = [
			['friction', 'friction'],
			['puma_friction', 'friction'],
			['brake_hysteresis', 'brake'],
			['encoder_delay', 'encoder'],
		].map(([id, kind]) => ({ id, kind, refused: possible.includes(id!) ? undefined : { reason: 'missing_instrument', text: 'no such instrument' } }) as Procedure);
		return procedureGroups(all).map((one) => [one.title, one.procedures.map(({ id }) => id).join()]);
	};
	expect(offered('friction', 'brake_hysteresis')).toEqual([
		['friction', 'friction'],
		['brake', 'brake_hysteresis'],
		['Not available with the default settings', 'puma_friction,encoder_delay'],
	]);
	expect(offered('friction', 'encoder_delay')[0]).toEqual(['encoder', 'encoder_delay']);
	expect(offered('puma_friction')[0]).toEqual(['friction', 'puma_friction']);
});
