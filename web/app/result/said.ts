import type { Identification, IdentifiedQuantity } from '../api/types';
import { type Scale, bounds, estimate, figure, scaleFor } from '../format/number';
import type { Mood } from '../ui/states';

const VERDICTS: Record<Identification['verdict'], { word: string; icon: string; mood: Mood }> = {
	identified: { word: 'IDENTIFIED', icon: '✓', mood: 'good' },
	identified_with_warning: { word: 'IDENTIFIED WITH A WARNING', icon: '⚠', mood: 'warn' },
	inconclusive: { word: 'INCONCLUSIVE', icon: '◔', mood: 'warn' },
	failed: { word: 'FAILED', icon: '✕', mood: 'bad' },
};

export const sayVerdict = (verdict: Identification['verdict']) => VERDICTS[verdict];

/** Held against a data sheet, the summary begins with what came of it: that is the word then, and the rest follows. */
export function judged(verdict: Identification['verdict'], summary: string) {
	const word = /^(PASS|OUT OF TOLERANCE)\b:? */.exec(summary);
	if (verdict !== 'identified' || !word) return { ...VERDICTS[verdict], rest: summary };
	const passed = word[1] === 'PASS';
	return { word: word[1]!, icon: passed ? '✓' : '✕', mood: (passed ? 'good' : 'bad') as Mood, rest: summary.slice(word[0].length) };
}

/** A quantity with one prefix for value and interval: `32.1 ± 0.4 µNm·s/rad`; an uneven interval is said by its ends. */
export function sayQuantity(of: Pick<IdentifiedQuantity, 'value' | 'unit' | 'ci95'>, shown: Scale = { factor: 1, unit: of.unit }): { value: string; interval: string; unit: string } {
	const [value, unit] = [of.value * shown.factor, shown.unit];
	const [low, high] = (of.ci95 ?? []).map((end) => end * shown.factor);
	if (low === undefined || high === undefined) {
		const scale = scaleFor(unit, value);
		return { value: unit === '' && Number.isInteger(value) ? String(value) : estimate(value * scale.factor, []), interval: '', unit: scale.unit };
	}
	const scale = scaleFor(unit, Math.max(Math.abs(value), Math.abs(low), Math.abs(high)));
	const scaled = [low * scale.factor, high * scale.factor] as const;
	const [below, above] = [value - low, high - value];
	const even = Math.abs(above - below) <= 0.02 * (above + below);
	const half = ((above + below) / 2) * scale.factor;
	return {
		value: estimate(value * scale.factor, scaled),
		interval: even && half > 0 ? `± ${figure(half, 2)}` : bounds(scaled),
		unit: scale.unit,
	};
}

/** What was found for each of several ways. */
export interface Table {
	ways: string[];
	rows: { symbol: string; title: string; of: IdentifiedQuantity[] }[];
}

/** A column for each way, where every symbol has a figure for each: their titles are alike up to a comma, and then name the way. */
export function tableOf(quantities: readonly IdentifiedQuantity[]): Table | null {
	const bySymbol = new Map<string, IdentifiedQuantity[]>();
	for (const one of quantities) bySymbol.set(one.symbol, [...(bySymbol.get(one.symbol) ?? []), one]);
	const rows = [...bySymbol].map(([symbol, of]) => {
		const parts = of[0]!.title.split(', ');
		const begins = parts.map((_, i) => parts.slice(0, i).join(', ')).findLast((begin) => of.every(({ title }) => title.startsWith(`${begin}, `)));
		return { symbol, title: begins ?? '', of };
	});
	const [ways = [], ...others] = rows.map(({ title, of }) => of.map((one) => one.title.slice(title.length + 2)));
	const whole = ways.length > 2 && others.length > 0 && others.every((more) => more.join('\n') === ways.join('\n'));
	return whole && quantities.every((one) => !one.ci95) ? { ways, rows } : null;
}

/** A part of a campaign: its line of the summary and what its figures are. */
export interface Part {
	id: string;
	title: string;
	verdict: Identification['verdict'];
	said: string;
	quantities: IdentifiedQuantity[];
	figures: Identification['figures'];
}

/** `Stiffness: …` or `Stiffness (failed): …` is a part's line, where there are several; the rest leads. Its figures carry its id and title. */
export function partsOf({ summary, quantities, figures }: Pick<Identification, 'summary' | 'quantities' | 'figures'>): { lead: string; parts: Part[] } {
	const lines = summary.split('\n');
	const found = lines.map((line) => /^([A-Z][^:.]*?)(?: \((inconclusive|failed)\))?: (.+)$/.exec(line));
	if (lines.length < 2) return { lead: summary, parts: [] };
	const parts = found.flatMap((match) => {
		if (!match) return [];
		const [, title, verdict, said] = match as unknown as [string, string, Part['verdict'] | undefined, string];
		const own = quantities.filter((one) => one.title.startsWith(`${title}: `));
		const id = own[0]?.name.split('.')[0] ?? title;
		return {
			id,
			title,
			verdict: verdict ?? 'identified',
			said,
			quantities: own.map((one) => ({ ...one, title: one.title.slice(title.length + 2) })),
			figures: figures.filter(({ name }) => name.startsWith(`${id}.`)),
		};
	});
	return { lead: lines.filter((_, i) => !found[i]).join(' '), parts };
}
