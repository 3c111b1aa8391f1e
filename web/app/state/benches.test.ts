import { expect, it } from 'vitest';
import { withBench } from './benches';

it('leaves every bench where it was', () => {
	const joint = { name: 'joint', state: 'idle' };
	const encoder = { name: 'encoder', state: 'idle' };
	const running = { name: 'joint', state: 'running' };
	expect(withBench([joint, encoder], running)).toEqual([running, encoder]);
	expect(withBench([joint], encoder)).toEqual([joint, encoder]);
	expect(withBench([], joint)).toEqual([joint]);
});
