import { describe, expect, it } from 'vitest';
import { KINDS, unitsOf } from './columns';
import { guess, guessKind, instructions, unitIn } from './guess';
import { parseHead, peek } from './peek';

const friction = KINDS[0]!;

describe('the mapping of a foreign table', () => {
	const headers = ['Time [ms]', 'pos_deg', 'Iq [A]', 'speed_rpm', 'Torque (mNm)'];
	const mapping = guess(friction, headers);

	it('is guessed from names and units', () => {
		expect(mapping['time_s']).toEqual({ from: 'Time [ms]', unit: 'ms' });
		expect(mapping['motor_position_rad']).toEqual({ from: 'pos_deg', unit: 'deg' });
		expect(mapping['motor_current_a']).toEqual({ from: 'Iq [A]', unit: 'A' });
		expect(mapping['motor_velocity_rad_s']).toEqual({ from: 'speed_rpm', unit: 'rpm' });
		expect(mapping['link_torque_nm']).toEqual({ from: 'Torque (mNm)', unit: 'mNm' });
		expect(mapping['segment']!.from).toBe('');
	});

	it('reads the unit of a column that is chosen by hand from its header', () => {
		const units = unitsOf('motor_position_rad');
		expect(['Winkel Motor (°)', 'phi', 'n (rpm)'].map((header) => unitIn(header, units))).toEqual(['deg', 'rad', 'rad']);
	});

	it('takes the load by the name that the page gives it', () => {
		for (const load of ['load', 'Load [Nm]', 'load_nm', 'Last']) expect(guess(friction, [load])['link_torque_nm']!.from).toBe(load);
	});

	it('tells a temperature from a time by its unit', () => {
		const mapping = guess(friction, ['t [s]', 'T [degC]']);
		expect([mapping['time_s']!.from, mapping['temperature_c']!.from]).toEqual(['t [s]', 'T [degC]']);
		expect(guess(friction, ['T_°C'])['time_s']!.from).toBe('');
	});

	it('becomes what the daemon understands', () => {
		const { map, scale } = instructions(mapping);
		expect(map).toContain('motor_current_a=Iq [A]');
		expect(scale).toContain('time_s=0.001');
		expect(scale.some((one) => one.startsWith('motor_current_a'))).toBe(false);
		expect(Number(scale.find((one) => one.startsWith('motor_position_rad'))!.split('=')[1])).toBeCloseTo(Math.PI / 180, 15);
	});

	it('leaves a table of the daemon alone', () => {
		const own = [...friction.required, 'temperature_c'];
		expect(instructions(guess(friction, own))).toEqual({ map: [], scale: [] });
	});
});

it.each(KINDS)('knows a $id table by its columns', (kind) => expect(guessKind(kind.required).id).toBe(kind.id));

it('reads the beginning of a text table, packed or not, and of no other', async () => {
	const text = 't, "v"\r\n0,1\n1,2\n';
	expect(parseHead(text)).toEqual({ headers: ['t', 'v'], rows: [['0', '1'], ['1', '2']] });
	expect(parseHead('\ufefft;"v, w"\r\n0,5;1\n')).toEqual({ headers: ['t', 'v, w'], rows: [['0,5', '1']] });
	expect(parseHead('t\tv\n0,5\t1').rows).toEqual([['0,5', '1']]);
	const packed = await new Response(new Blob([text]).stream().pipeThrough(new CompressionStream('gzip'))).arrayBuffer();
	expect((await peek(new File([packed], 'a.CSV.gz')))?.headers).toEqual(['t', 'v']);
	expect(await peek(new File(['PAR1'], 'a.parquet'))).toBeNull();
});
