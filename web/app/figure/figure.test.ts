import { describe, expect, it } from 'vitest';
import { cartesianLayout, titleMiddle } from './cartesian';
import { type Figure, type Series, inDisplayUnits, magnification, magnified, reachOf, styles, tableOf } from './figure';
import { glyphs, line, ribbon } from './paths';
import { legendLayout } from './legendLayout';
import { polarLayout } from './polar';

const series = (label: string, mark: Series['mark'], x: number[], y: number[], band?: number[][]): Series => ({ label, mark, x, y, band });
const grouped = (label: string, group: string): Series => ({ ...series(label, 'line', [], []), group });
const figure = (more: Partial<Figure>): Figure => ({
	name: 'f',
	title: 'Friction',
	form: 'cartesian',
	x: { label: 'velocity', unit: 'rad/s' },
	y: { label: 'torque', unit: 'Nm' },
	series: [],
	...more,
});

describe('telling series apart', () => {
	it('draws a model in the colour of its points, and no two series alike', () => {
		const points = ['positive', 'negative'].map((label) => series(label, 'points', [], []));
		const looks = styles([...points, grouped('model, positive', 'positive'), grouped('model, negative', 'negative'), series('line', 'line', [], [])]);
		expect(looks[2]!.stroke).toBe(looks[0]!.stroke);
		expect(looks[3]!.stroke).toBe(looks[1]!.stroke);
		expect(new Set(looks.map((look) => look.stroke)).size).toBe(3);
		expect(new Set(looks.slice(2).map((look) => look.dash)).size).toBe(3);
		expect(looks[0]!.glyph).not.toBe(looks[1]!.glyph);
	});

	it('draws alike what has one name', () => {
		const looks = styles(['major', 'reversal', 'reversal', 'minor'].map((label) => series(label, 'line', [], [])));
		expect(looks[1]).toEqual(looks[2]);
		expect(looks[3]!.dash).not.toBe(looks[2]!.dash);
	});

	it('draws a run as the plot above draws it, and its second curve in the same colour', () => {
		const [mean, apart] = [['#1', '#2', '#1', '#2'], ['#2', '#2']].map((runs) => styles(runs.map((run, i) => grouped(`${run}, ${i}`, run)), ['#1', '#2']));
		expect([apart![0], apart![1]].map((look) => [look!.stroke, look!.dash])).toEqual([mean![1], mean![3]].map((look) => [look!.stroke, look!.dash]));
		expect(mean![0]!.stroke).not.toBe(mean![1]!.stroke);
		expect(new Set(mean!.map((look) => look.dash)).size).toBe(4);
	});

	it('never comes back to the same colour and dash within thirty lines', () => {
		const looks = styles(Array.from({ length: 30 }, (_, i) => series(`line ${i}`, 'line', [], [])));
		expect(new Set(looks.map((look) => look.stroke + look.dash)).size).toBe(30);
	});
});

describe('a cartesian figure', () => {
	const drawn = figure({ series: [series('a', 'points', [0, 10], [0.01, 0.04], [[0, 0.02], [0.03, 0.05]])] });

	it('shows points with their bands, ticks with the prefix', () => {
		const frame = cartesianLayout(drawn, 400, 300, { x: 1, y: 1000 });
		for (const y of [0, 0.05]) expect(frame.y(y) > frame.top && frame.y(y) < frame.bottom).toBe(true);
		expect(frame.yTicks.map((tick) => tick.text)).toEqual(['0', '10', '20', '30', '40', '50']);
		expect(frame.yTicks[1]!.at).toBeCloseTo(frame.y(0.01), 9);
	});

	it('stands bars on zero, each in its slot', () => {
		const bars = figure({ x: { label: '', unit: '', names: ['one', 'two'] }, series: [series('a', 'bars', [0, 1], [3, 4]), series('b', 'bars', [0, 1], [5, 2])] });
		expect(reachOf(bars.series)).toEqual([0, 5]);
		const frame = cartesianLayout(bars, 400, 300, { x: 1, y: 1 });
		expect(frame.y(0)).toBe(frame.bottom);
		expect(frame.xTicks.map((tick) => tick.text)).toEqual(['one', 'two']);
		expect(2 * frame.bar).toBeLessThan(frame.x(1) - frame.x(0));
		expect(frame.slanted).toBe(false);
	});

	it('survives what has no extent', () => {
		for (const one of [[], [series('a', 'line', [3], [7])], [series('a', 'points', [Number.NaN], [Number.NaN])]]) {
			const frame = cartesianLayout(figure({ series: one }), 300, 200, { x: 1, y: 1 });
			for (const value of [frame.x(3), frame.y(7)]) expect(Number.isFinite(value)).toBe(true);
		}
	});
});

it('keeps the centre free where a polar figure has two signs, and starts there where it has one', () => {
	const round = (y: number[]) => polarLayout(figure({ form: 'polar', series: [series('a', 'line', [0, 1, 2], y)] }), 300, 300, 1);
	const signed = round([-1, 0, 1]);
	expect(signed.radius(-1)).toBeGreaterThan(signed.outer * 0.2);
	expect(signed.radius(1)).toBeLessThan(signed.outer);
	expect(signed.zero).toBeCloseTo(signed.radius(0), 9);
	const plain = round([1, 2, 3]);
	expect([plain.radius(0), plain.zero]).toEqual([0, null]);
	const [x, y] = plain.at(Math.PI / 2, 3);
	expect([x, y < plain.centre.y]).toEqual([plain.centre.x, true]);
});

it('gives exactly what is drawn, with all digits and names', () => {
	const drawn = figure({ x: { label: 'of what', unit: '', names: ['eccentricity, first'] }, series: [series('a', 'bars', [0], [0.0311234567], [[0.03, 0.032]])] });
	expect(tableOf(drawn)).toEqual({ head: ['series', 'of what', 'torque [Nm]', 'torque [Nm], lower', 'torque [Nm], upper'], rows: [['a', 'eccentricity, first', 0.0311234567, 0.03, 0.032]] });
});

it('is shown in the units that a person reads', () => {
	const drawn = figure({ series: [series('a', 'line', [1, 2], [3, 4], [[2, 4], [3, 5]])] });
	const shown = inDisplayUnits(drawn, (unit) => (unit === 'rad/s' ? { factor: 10, unit: 'rpm' } : { factor: 1, unit }));
	expect([shown.x.unit, shown.series[0]!.x, shown.series[0]!.band]).toEqual(['rpm', [10, 20], [[2, 4], [3, 5]]]);
	expect(inDisplayUnits(drawn, (unit) => ({ factor: 1, unit }))).toBe(drawn);
});

it('breaks a line where a value is missing', () => {
	expect(line([[0, 0], [1, 1], [2, Number.NaN], [3, 3]])).toBe('M0.0 0.0L1.0 1.0M3.0 3.0');
	expect(ribbon([], [])).toBe('');
	expect(glyphs([[Number.NaN, 1]], 'dot')).toBe('');
});

it('puts entries of a legend below each other where they do not fit', () => {
	const { entries, height } = legendLayout(['positive', 'negative', 'model'], 170);
	expect(entries.map((one) => one.y > 0)).toEqual([false, false, true]);
	expect(height).toBe(34);
});

it('a title longer than its axis begins at the top edge and is not cut', () => {
	const frame = { top: 8, bottom: 180 };
	expect(titleMiddle('torque [Nm]', frame)).toBe(94);
	const long = 'Fraction of the manufacturing tolerance';
	expect(titleMiddle(long, frame) - (long.length * 6.1) / 2).toBeCloseTo(0);
});

it('draws a small remainder larger, in all figures alike, and says how much', () => {
	const of = (label: string, role: Series['role'], y: number[], mark: Series['mark'] = 'line') => ({ ...series(label, mark, [0, 1], y, y.map((value) => [value, value])), role });
	const turn = figure({ series: [of('CW, before', 'before', [3, -5]), of('CW, after', 'after', [0.1, 0])] });
	const harmonics = figure({ x: { label: '', unit: '', names: ['1×', '2×'] }, series: [of('before', 'before', [4, 1], 'bars'), of('after', 'after', [0.03, 0.02], 'bars'), of('noise', null, [0.01, 0.01])] });
	const whole = figure({ series: [of('before', 'before', [3]), of('after', 'after', [1])] });
	expect([magnification([turn, harmonics, whole]), magnification([whole])]).toEqual([50, Infinity]);
	expect(magnified(turn, 50).series.map(({ label, y }) => [label, y])).toEqual([
		['CW, before', [3, -5]],
		['CW, after, ×50', [5, 0]],
	]);
	expect(magnified(harmonics, 50).series.map(({ label, y, band }) => [label, y[0], band![0]![1]])).toEqual([
		['before', 4, 4],
		['after, ×50', 1.5, 1.5],
		['noise', 0.01, 0.01],
		['noise, ×50', 0.5, 0.5],
	]);
	const looks = styles(magnified(harmonics, 50).series);
	expect(looks[3]!.stroke).toBe(looks[1]!.stroke);
	expect(magnified(whole, 50)).toBe(whole);
});
