import { expect, it } from 'vitest';
import { formatCountdown, formatDateTime, formatDuration, formatRunTime, formatShortDuration } from './time';

it('says durations', () => {
	expect([0.44, 43.2, 380, 7500, null].map(formatDuration)).toEqual(['0.4 s', '43 s', '6 min 20 s', '2 h 5 min', '–']);
});

it('shortens durations to their largest unit', () => {
	expect([0.44, 43.2, 59.7, 60, 380, 7500, Infinity].map(formatShortDuration)).toEqual(['0.4 s', '43 s', '1 min', '1 min', '6 min', '2 h', '–']);
});

it('counts down', () => {
	expect([231, 5, 3725, -3].map(formatCountdown)).toEqual(['3:51', '0:05', '1:02:05', '0:00']);
});

it('separates the thousands of a time of a run', () => {
	expect([0, 12.34, 12345.67].map(formatRunTime)).toEqual(['0.0 s', '12.3 s', '12,345.7 s']);
});

it('keeps what is not a date', () => {
	expect(formatDateTime('soon')).toBe('soon');
	expect(formatDateTime('2026-11-20T16:31:00')).toBe('2026-11-20 16:31');
});
