import { expect, it } from 'vitest';
import { isStale } from './channelHealth';

it('calls a channel old after three of its periods, and never within a second', () => {
	expect(isStale({ rate_hz: 250 }, 0.9)).toBe(false);
	expect(isStale({ rate_hz: 250 }, 1.1)).toBe(true);
	expect(isStale({ rate_hz: 0.5 }, 5.9)).toBe(false);
	expect(isStale({ rate_hz: 0.5 }, 6.1)).toBe(true);
	expect(isStale({ rate_hz: null }, Infinity)).toBe(true);
});
