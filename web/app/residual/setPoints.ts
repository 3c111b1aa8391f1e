/** Largest number of set-points. An axis with more values is not a commanded quantity. */
const MAX_SET_POINTS = 40;
/** Set-points that are closer than this fraction of the span, of their own value, or than their scatter, are merged. */
const MERGE_SPAN = 0.002;
const MERGE_RELATIVE = 0.05;
/** A segment that moves over more than this fraction of the span is not at a set-point. */
const MAX_SCATTER = 0.03;

/** The set-points of an axis in rising order, or `null` if the run does not stay at any. */
export function detectSetPoints(points: readonly { value: number; segment: number }[], span: number): number[] | null {
	const segments = [...summaries(points)].filter((each) => each.scatter <= MAX_SCATTER * span);
	const atSetPoint = segments.reduce((n, each) => n + each.n, 0);
	if (atSetPoint < 0.7 * points.length) return null;
	segments.sort((a, b) => a.mean - b.mean);
	const scatter = Math.sqrt(segments.reduce((sum, each) => sum + each.n * each.scatter ** 2, 0) / atSetPoint);
	const minDistance = Math.max(MERGE_SPAN * span, 3 * scatter);
	const groups: { n: number; sum: number; last: number }[] = [];
	for (const { n, mean } of segments) {
		const group = groups.at(-1);
		if (group && mean - group.last <= Math.max(minDistance, MERGE_RELATIVE * Math.abs(mean))) Object.assign(group, { n: group.n + n, sum: group.sum + n * mean, last: mean });
		else groups.push({ n, sum: n * mean, last: mean });
	}
	const chained = groups.some((group) => group.last - group.sum / group.n > 4 * Math.max(minDistance, MAX_SCATTER * span));
	if (chained || groups.length < 2 || groups.length > MAX_SET_POINTS) return null;
	return groups.map((group) => group.sum / group.n);
}

function* summaries(points: readonly { value: number; segment: number }[]) {
	const bySegment = new Map<number, number[]>();
	for (const { value, segment } of points) {
		const list = bySegment.get(segment);
		if (list) list.push(value);
		else bySegment.set(segment, [value]);
	}
	for (const values of bySegment.values()) {
		const n = values.length;
		const mean = values.reduce((sum, value) => sum + value, 0) / n;
		const scatter = Math.sqrt(values.reduce((sum, value) => sum + (value - mean) ** 2, 0) / n);
		yield { n, mean, scatter };
	}
}
