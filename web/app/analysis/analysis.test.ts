import { expect, it } from 'vitest';
import { choicesOf, derivedOf, readDerived, readOver, writeDerived } from './derivedChannels';
import { pairsOf } from './xyPoints';

it('takes title and unit from in front of a formula', () => {
	expect(derivedOf('drive power [W] = a * b')).toEqual({ formula: 'a * b', title: 'drive power', unit: 'W' });
	expect(derivedOf('derivative(a)')).toEqual({ formula: 'derivative(a)', title: 'derivative(a)', unit: null });
	expect(derivedOf('slip = a - b')).toEqual({ formula: 'a - b', title: 'slip', unit: null });
});

it('keeps derived channels in the address, each once', () => {
	const text = writeDerived(['a * b', 'smooth(a, 0.02)', 'a * b']);
	expect(readDerived(text)).toEqual(['a * b', 'smooth(a, 0.02)']);
	expect(writeDerived([])).toBeNull();
	expect(readOver('b;a')).toEqual({ y: 'b', x: 'a' });
	expect(readOver('b')).toBeNull();
});

it('offers the channels of the run and what was derived from them', () => {
	const choices = choicesOf([{ name: 'segment' }, { name: 'motor_current_a', unit: 'A' }], ['p [W] = a * b']);
	expect(choices).toEqual([{ formula: 'motor_current_a', title: 'motor current', unit: 'A' }, { formula: 'a * b', title: 'p', unit: 'W' }]);
});

it('puts points in the order of x, apart by direction', () => {
	const { x, columns } = pairsOf([3, 1, null, 2], [30, 10, 5, 20], [1, -1, 1, 1]);
	expect(x).toEqual([1, 2, 3]);
	expect(columns).toEqual([[null, 20, 30], [10, null, null]]);
	expect(pairsOf([2, 1], [1, null], null)).toEqual({ x: [2], columns: [[1]] });
});
