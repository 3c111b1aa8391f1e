import { expect, it } from 'vitest';
import { renewed } from './benches';

it('leaves every bench where it was', () => {
	const joint = { name: 'joint', state: 'idle' };
	const encoder = { name: 'encoder', state: 'idle' };
	const running = { name: 'joint', state: 'running' };
	expect(renewed([joint, encoder], running)).toEqual([running, encoder]);
	expect(renewed([joint], encoder)).toEqual([joint, encoder]);
	expect(renewed([], joint)).toEqual([joint]);
});
