import type { Model } from '../api/types';
import { formatChange, formatQuantity } from '../format/number';
import { MIN_GAIN, gain, gainText, sameData, undecided } from './versionTree';

export interface Notice {
	text: string;
	good: boolean;
}

/**
 * The change in the words of a comparison. For a trial, only the undetermined results, because the comparison shows the
 * rest.
 */
export function changeNotice(before: Model, after: Model, isKept = true): Notice | null {
	if (!sameData(before, after)) return null;
	const share = gain(before, after);
	const open = share > MIN_GAIN ? undecided(before, after) : [];
	if (!isKept && open.length === 0) return null;
	const stays = after.added.length === 0 && Math.abs(share) <= MIN_GAIN;
	const [was, is] = [before, after].map((one) => formatQuantity(one.validation_rms, one.fit.unit));
	const errorText = `Validation error ${was} → ${is}: ${stays ? '≈ as before' : gainText(share)} (${formatChange(-share)})`;
	if (open.length > 0) return { text: `${errorText}, but this data does not decide ${open.join(', ')}: ${isKept ? 'undo with z, or ' : ''}give what is searched for a range that the run can show.`, good: false };
	const good = stays || share > MIN_GAIN;
	return { text: `${errorText}.${good ? '' : ' Undo with z.'}`, good };
}
