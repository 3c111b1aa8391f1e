import { expect, it } from 'vitest';
import { ageOf, isOld } from './health';

it('calls a channel old after three of its periods, and never within a second', () => {
	const now = Date.parse('2026-01-01T00:00:10Z');
	const age = (at: string | null) => ageOf({ at }, now);
	expect(age('2026-01-01T00:00:06Z')).toBe(4);
	expect(age('2026-01-01T00:00:11Z')).toBe(0);
	expect(isOld({ rate_hz: 250 }, 0.9)).toBe(false);
	expect(isOld({ rate_hz: 250 }, 1.1)).toBe(true);
	expect(isOld({ rate_hz: 0.5 }, 5.9)).toBe(false);
	expect(isOld({ rate_hz: 0.5 }, 6.1)).toBe(true);
	expect(isOld({ rate_hz: null }, age(null))).toBe(true);
});
