import { expect, it } from 'vitest';
import type { ResidualSet } from '../api/types';
import { regionRun } from './measureHere';

const set = (velocity: number[], load: number[]) =>
	({ axes: [{ name: 'motor_velocity_rad_s', unit: 'rad/s', values: velocity }, { name: 'link_torque_nm', unit: 'Nm', values: load }], error: velocity.map(() => 0) }) as unknown as ResidualSet;
const all = (n: number) => new Uint8Array(n).fill(1);
const run = { parameters: { order_seed: 3 }, meta: { sample_rate_hz: 250 }, provenance: { constants: { brake_rated_torque_nm: 13, gear_ratio: 100 } } };

it('goes to the speeds of the samples under their load, in another order than before', () => {
	const found = regionRun(set([-20, 20, 100, -100], [4, -4, 4.2, 4]), all(4), run)!;
	expect(found.parameters).toMatchObject({ low_speed_rad_s: 20, top_speed_rad_s: 100, speeds: 4, load: 0.31, order_seed: 4, sample_rate_hz: 250 });
	expect(found.load_nm).toBe(4);
});

it('goes to one speed where there is one, far enough to hold it', () => {
	const { parameters } = regionRun(set([180.4, 179.8, -180.2], [0.1, 0.1, 0.1]), all(3), run)!;
	expect(parameters).toMatchObject({ low_speed_rad_s: 180, top_speed_rad_s: 180, speeds: 1, load: 0 });
	expect(parameters['travel_rad']! * 100).toBeGreaterThan(180 * 0.6 + 180 ** 2 / 400);
});

it('says what it does not know, and makes no run of what does not move', () => {
	expect(regionRun(set([20, 21], [4, 4]), all(2), { ...run, provenance: {} })).toMatchObject({ loadUnknown: true, parameters: { load: 0 } });
	expect(regionRun(set([20, 0], [4, 4]), Uint8Array.of(0, 1), run)).toBeNull();
});
