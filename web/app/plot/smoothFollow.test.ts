import { expect, it } from 'vitest';
import { smoothFollow } from './smoothFollow';

const PICTURE_MS = 1000 / 60;

/** End times of two seconds of images, for a stream in real time with one frame every `every_ms`. */
function ends(every_ms: number): number[] {
	const list: number[] = [];
	for (let now_ms = 0; now_ms < 2000; now_ms += PICTURE_MS) {
		const newest_s = (Math.floor(now_ms / every_ms) * every_ms) / 1000;
		list.push(smoothFollow(list.at(-1) ?? null, newest_s, PICTURE_MS));
	}
	return list;
}

it.each([34, 50])('moves on in every picture, evenly, although frames come every %i ms', (every_ms) => {
	const late = ends(every_ms).slice(60);
	const steps = late.slice(1).map((end, i) => 1000 * (end - late[i]!));
	expect(Math.min(...steps)).toBeGreaterThan(0.7 * PICTURE_MS);
	expect(Math.max(...steps)).toBeLessThan(1.4 * PICTURE_MS);
	expect(2 - late.at(-1)!).toBeLessThan(0.2);
});

it('begins and ends at the newest sample, and goes back with a new run', () => {
	expect(smoothFollow(null, 7, 16)).toBe(7);
	expect(smoothFollow(7, 7.01, 1000)).toBe(7.01);
	expect(smoothFollow(300, 0.5, 16)).toBe(0.5);
});
