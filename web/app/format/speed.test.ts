import { expect, it } from 'vitest';
import { withDisplayedSpeeds } from './speed';

it('says the speeds of a sentence in rpm, and leaves everything else', () => {
	const said = 'the model is 12 mNm too low at a motor velocity between 0.5 rad/s and 170 rad/s, −20 mrad/s, 3 rad/s²';
	expect(withDisplayedSpeeds(said, true)).toBe('the model is 12 mNm too low at a motor velocity between 4.77 rpm and 1620 rpm, −0.191 rpm, 3 rad/s²');
	expect(withDisplayedSpeeds(said, false)).toBe(said);
});
