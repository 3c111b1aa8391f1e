import type { IdentifiedQuantity, Trends } from '../api/types';
import type { Figure, Series } from '../figure/figure';
import type { Scale } from '../format/number';
import { formatDateTime } from '../format/time';
import { baseTitle } from '../result/presentation';

export const AXES = ['run', 'time', 'temperature', 'unit', 'bench', 'tag'] as const;
export type TrendAxis = (typeof AXES)[number];

type TrendRun = Trends['runs'][number];
/** Largest number of runs that can be named along an axis. */
const NAMED = 30;

export interface TrendQuantity {
	name: string;
	title: string;
	/** Title without the configuration, which can contain a measured speed. */
	base_title: string;
	symbol: string;
	unit: string;
	/** Number of runs with this quantity. */
	n: number;
}

/**
 * Every quantity of at least one run, the most frequent first. Runs may use one name for two quantities: the title is
 * that of most runs. If the configuration differs between runs, the name replaces it.
 */
export function trendQuantities(results: readonly (readonly IdentifiedQuantity[])[]): TrendQuantity[] {
	const found = new Map<string, TrendQuantity>();
	for (const { name, title: own, symbol, unit, ...more } of results.flat()) {
		const base_title = baseTitle({ title: own, ...more });
		const key = `${name} ${base_title}`;
		const former = found.get(key);
		const title = former && former.title !== own ? `${base_title} (${name})` : own;
		found.set(key, { name, title, base_title, symbol, unit, n: (former?.n ?? 0) + 1 });
	}
	const ranked = [...found.values()].sort((a, b) => b.n - a.n);
	return ranked.filter((one, i) => ranked.findIndex(({ name }) => name === one.name) === i);
}

const UNITS: [string, number][] = [['d', 86_400], ['h', 3600], ['min', 60]];
const seconds = (one: TrendRun) => Date.parse(one.created_at) / 1000;

interface TrendPositions {
	label: string;
	unit: string;
	names?: string[];
	/** Position of a run; `null` without a position. */
	at: (one: TrendRun, i: number) => number | null;
}

function trendPositions(axis: TrendAxis, runs: readonly TrendRun[]): TrendPositions {
	const named = (label: string, of: (one: TrendRun) => string): TrendPositions => {
		const names = [...new Set(runs.map(of))];
		return { label, unit: '', names, at: (one) => names.indexOf(of(one)) };
	};
	if (axis === 'temperature') return { label: 'mean temperature', unit: '°C', at: ({ temperature_c }) => temperature_c ?? null };
	if (axis === 'unit') return named('unit under test', ({ unit }) => unit ?? 'no unit');
	if (axis === 'bench') return named('bench', ({ bench }) => bench);
	if (axis === 'tag') return named('first tag', ({ tags }) => tags[0] ?? 'no tag');
	if (axis === 'run') return runs.length > NAMED ? { label: 'run', unit: '', at: ({ run }) => run } : { ...named('run', ({ run }) => `#${run}`), at: (_one, i) => i };
	const first = runs[0] ? seconds(runs[0]) : 0;
	const span = runs.length > 0 ? seconds(runs.at(-1)!) - first : 0;
	const [unit, size] = UNITS.find(([, size]) => span >= 2 * size) ?? ['s', 1];
	return { label: `time since ${runs[0] ? formatDateTime(runs[0].created_at) : ''}`, unit, at: (one) => (seconds(one) - first) / size };
}

/**
 * A quantity over runs with its intervals, one series per bench; `null` if no run has both the quantity and a position.
 */
export function trendFigure({ runs: all }: Trends, quantity: string, axis: TrendAxis, scale: (unit: string) => Scale): Figure | null {
	const shown = trendQuantities(all.map(({ quantities }) => quantities)).find(({ name }) => name === quantity);
	if (!shown) return null;
	const quantityOf = ({ quantities }: TrendRun) => quantities.find((one) => one.name === quantity && baseTitle(one) === shown.base_title);
	const runs = all.filter(quantityOf);
	const { at, ...x } = trendPositions(axis, runs);
	const { factor, unit } = scale(shown.unit);
	const series = new Map<string, Series & { band: number[][] }>();
	runs.forEach((one, i) => {
		const found = quantityOf(one)!;
		const place = at(one, i);
		if (place === null) return;
		const own = series.get(one.bench) ?? { label: one.bench, mark: 'points' as const, x: [], y: [], band: [] };
		series.set(one.bench, own);
		own.x.push(place);
		own.y.push(found.value * factor);
		own.band.push((found.ci95 ?? [found.value, found.value]).map((end) => end * factor));
	});
	return series.size > 0 ? { name: `trend-${quantity}`, title: shown.title, form: 'cartesian', x, y: { label: shown.title, unit }, series: [...series.values()] } : null;
}
