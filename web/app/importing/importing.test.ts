import { beforeEach, describe, expect, it } from 'vitest';
import type { ImportPreview } from '../api/types';
import { loadMapping, optionsText, saveMapping, timeSourceOf, withOptions, withTimeSource, withoutOption } from './importOptions';
import { mappingOptions, unitsOf } from './columns';
import { unzip } from './unpack';

describe('options that the daemon proposes', () => {
	const option = (name: string, value = 'true') => ({ name, value });

	it('are said in words', () => {
		expect(optionsText([option('missing', '-9999'), option('leave_empty_rows')])).toBe('-9999 is an empty cell, omit rows with empty cells');
		expect(optionsText([option('decimal', 'I [mA]=comma')])).toBe('I [mA]: decimal comma');
		expect(optionsText([option('time_from_rate', '200')])).toBe('200 rows a second');
		expect(optionsText([option('scale', 'motor_current_a=-1')])).toBe('motor_current_a × −1');
	});

	it('give the time from one place', () => {
		const counted = withTimeSource({ spread_time: ['true'], leave: ['remark'] }, 'rate', '200', true);
		expect([counted, timeSourceOf(counted)]).toEqual([{ leave: ['remark'], time_from_rate: ['200'] }, 'rate']);
		expect(withTimeSource(counted, 'rate', '200', false)).toEqual({ leave: ['remark'], rate: ['200'] });
		expect(withTimeSource(counted, 'column', '', true)).toEqual({ leave: ['remark'] });
		expect(timeSourceOf({ operating_points: ['true'] })).toBe('operating_points');
	});

	it('are taken, exchanged and taken back', () => {
		const once = withOptions({ leave: ['remark'] }, [option('unit', 'time_s=ms')]);
		expect(withOptions(once, [option('unit', 'time_s=us')])).toEqual({ leave: ['remark'], unit: ['time_s=us'] });
		expect(withOptions({ time_from_rate: ['100'] }, [option('time_from_rate', '200')])).toEqual({ time_from_rate: ['200'] });
		expect(withoutOption(once, 'unit', 'time_s=ms')).toEqual({ leave: ['remark'] });
	});
});

describe('what a person chose', () => {
	const preview = (...names: string[]) => ({ columns: names.map((name) => ({ name })) }) as ImportPreview;
	let kept: Record<string, string> = {};
	const storage = { getItem: (key: string) => kept[key] ?? null, setItem: (key: string, value: string) => void (kept[key] = value) } as unknown as Storage;
	beforeEach(() => (kept = {}));

	it('comes back for a file of the same shape', () => {
		const what = { kind: 'friction', mapping: { time_s: { from: 't', unit: 'ms' } }, facts: {}, left: [], choices: {} };
		saveMapping(preview('t', 'x'), what, storage);
		expect(loadMapping(preview('t', 'x'), storage)).toEqual(what);
		expect(loadMapping(preview('t', 'y'), storage)).toBeNull();
	});

	it('becomes what the daemon understands', () => {
		const mapping = { time_s: { from: 'Time', unit: '' }, motor_position_rad: { from: 'pos', unit: 'deg' }, motor_current_a: { from: 'motor_current_a', unit: 'A' }, segment: { from: '', unit: '' } };
		expect(mappingOptions(mapping)).toEqual({ map: ['time_s=Time', 'motor_position_rad=pos'], unit: ['motor_position_rad=deg'] });
		expect(unitsOf('motor_velocity_rad_s', '1/min')).toEqual(['rad/s', 'rpm', 'deg/s', 'rev/s', '1/min']);
	});
});

/** A zip archive of one file, in the format of `zip`. */
async function zip(name: string, text: string, method: 0 | 8): Promise<File> {
	const plain = new TextEncoder().encode(text);
	const packed = method === 0 ? plain : new Uint8Array(await new Response(new Blob([plain]).stream().pipeThrough(new CompressionStream('deflate-raw'))).arrayBuffer());
	const named = new TextEncoder().encode(name);
	const record = (size: number, fields: [at: number, bytes: 2 | 4, value: number][]) => {
		const view = new DataView(new ArrayBuffer(size));
		for (const [at, bytes, value] of fields) bytes === 2 ? view.setUint16(at, value, true) : view.setUint32(at, value, true);
		return new Uint8Array(view.buffer);
	};
	const local = record(30, [[0, 4, 0x04034b50], [8, 2, method], [18, 4, packed.length], [22, 4, plain.length], [26, 2, named.length]]);
	const entry = record(46, [[0, 4, 0x02014b50], [10, 2, method], [20, 4, packed.length], [24, 4, plain.length], [28, 2, named.length]]);
	const from = local.length + named.length + packed.length;
	const end = record(22, [[0, 4, 0x06054b50], [8, 2, 1], [10, 2, 1], [12, 4, entry.length + named.length], [16, 4, from]]);
	return new File([local, named, packed, entry, named, end], 'runs.zip');
}

describe('a zip archive', () => {
	it.each([0, 8] as const)('gives its tables (method %i)', async (method) => {
		const [file] = await unzip(await zip('day 1/run.csv', 't,x\n0,1\n', method));
		expect([file?.name, await file?.text()]).toEqual(['run.csv', 't,x\n0,1\n']);
		expect(await unzip(await zip('notes.docx', 'x', method))).toEqual([]);
	});

	it('that is none is refused', async () => {
		await expect(unzip(new File(['PK'], 'runs.zip'))).rejects.toThrow('runs.zip is no whole zip archive');
	});
});
