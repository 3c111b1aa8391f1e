import { expect, it } from 'vitest';
import { signalsOf, parseDerived, readDerived, readAxes, writeDerived } from './derivedChannels';
import { xyPoints } from './xyPoints';

it('takes title and unit from in front of a formula', () => {
	expect(parseDerived('drive power [W] = a * b')).toEqual({ formula: 'a * b', title: 'drive power', unit: 'W' });
	expect(parseDerived('derivative(a)')).toEqual({ formula: 'derivative(a)', title: 'derivative(a)', unit: null });
	expect(parseDerived('slip = a - b')).toEqual({ formula: 'a - b', title: 'slip', unit: null });
});

it('keeps derived channels in the address, each once', () => {
	const text = writeDerived(['a * b', 'smooth(a, 0.02)', 'a * b']);
	expect(readDerived(text)).toEqual(['a * b', 'smooth(a, 0.02)']);
	expect(writeDerived([])).toBeNull();
	expect(readAxes('b;a')).toEqual({ y: 'b', x: 'a' });
	expect(readAxes('b')).toBeNull();
});

it('offers the channels of the run and what was derived from them', () => {
	const choices = signalsOf([{ name: 'segment' }, { name: 'motor_current_a', unit: 'A' }], ['p [W] = a * b']);
	expect(choices).toEqual([{ formula: 'motor_current_a', title: 'motor current', unit: 'A' }, { formula: 'a * b', title: 'p', unit: 'W' }]);
});

it('puts points in the order of x, apart by direction', () => {
	const { x, columns } = xyPoints([3, 1, null, 2], [30, 10, 5, 20], [1, -1, 1, 1]);
	expect(x).toEqual([1, 2, 3]);
	expect(columns).toEqual([[null, 20, 30], [10, null, null]]);
	expect(xyPoints([2, 1], [1, null], null)).toEqual({ x: [2], columns: [[1]] });
});
