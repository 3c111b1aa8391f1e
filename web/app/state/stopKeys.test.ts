import { expect, it } from 'vitest';
import { StopKeys, DOUBLE_PRESS_MS } from './stopKeys';

const key = (key: string, timeStamp: number, more = {}) => ({ key, code: key, ctrlKey: false, shiftKey: false, repeat: false, timeStamp, ...more });
const chord = { key: ' ', code: 'Space', ctrlKey: true, shiftKey: true, repeat: false, timeStamp: 0 };

it('stops by the chord at any time and anywhere', () => {
	expect(new StopKeys().press(chord, true, true)).toBe('stop');
	expect(new StopKeys().press(chord, false, true)).toBe('stop');
	expect(new StopKeys().press({ ...chord, shiftKey: false }, true, false)).toBe(null);
});

it('stops an active bench by Esc twice', () => {
	const keys = new StopKeys();
	expect(keys.press(key('Escape', 0), true, false)).toBe('again');
	expect(keys.press(key('Escape', DOUBLE_PRESS_MS - 1), true, false)).toBe('stop');
});

it('does not stop an idle bench by Esc twice', () => {
	const keys = new StopKeys();
	expect(keys.press(key('Escape', 0), false, false)).toBe(null);
	expect(keys.press(key('Escape', 100), false, false)).toBe(null);
});

it('does not count an Esc that closes something, nor one that came long before', () => {
	const keys = new StopKeys();
	expect(keys.press(key('Escape', 0), true, true)).toBe(null);
	expect(keys.press(key('Escape', 100), true, false)).toBe('again');
	expect(keys.press(key('Escape', 100 + DOUBLE_PRESS_MS), true, false)).toBe('again');
	expect(keys.press(key('a', 1100), true, false)).toBe(null);
	expect(keys.press(key('Escape', 1200), true, false)).toBe('again');
	expect(keys.press(key('Escape', 1210, { repeat: true }), true, false)).toBe(null);
});
