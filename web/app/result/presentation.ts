import type { CampaignPart, Identification, IdentifiedQuantity } from '../api/types';
import { type Scale, formatInterval, formatEstimate, formatNumber, scaleFor } from '../format/number';
import type { StatusLabel, Tone } from '../ui/states';

const VERDICTS: Record<Identification['verdict'], StatusLabel> = {
	identified: { label: 'IDENTIFIED', icon: '✓', tone: 'good' },
	identified_with_warning: { label: 'IDENTIFIED WITH A WARNING', icon: '⚠', tone: 'warn' },
	inconclusive: { label: 'INCONCLUSIVE', icon: '◔', tone: 'warn' },
	failed: { label: 'FAILED', icon: '✕', tone: 'bad' },
};

export const verdictLabel = (verdict: Identification['verdict']) => VERDICTS[verdict];

/**
 * The verdict in a word. If the result was compared with a data sheet, the word is the outcome of that, with which the
 * summary starts.
 */
export function resultVerdict({ verdict, passes }: Pick<Identification, 'verdict' | 'passes'>, summary: string) {
	if (verdict !== 'identified' || passes == null) return { ...VERDICTS[verdict], rest: summary };
	const word = passes ? 'PASS' : 'OUT OF TOLERANCE';
	return { label: word, icon: passes ? '✓' : '✕', tone: (passes ? 'good' : 'bad') as Tone, rest: summary.replace(new RegExp(`^${word}:? *`), '') };
}

/**
 * A quantity with one prefix for value and interval: `32.1 ± 0.4 µNm·s/rad`; an asymmetric interval is given by its
 * ends.
 */
export function formatResult(of: Pick<IdentifiedQuantity, 'value' | 'unit' | 'ci95'>, shown: Scale = { factor: 1, unit: of.unit }): { value: string; interval: string; unit: string } {
	const [value, unit] = [of.value * shown.factor, shown.unit];
	const [low, high] = (of.ci95 ?? []).map((end) => end * shown.factor);
	if (low === undefined || high === undefined) {
		const scale = scaleFor(unit, value);
		return { value: unit === '' && Number.isInteger(value) ? String(value) : formatEstimate(value * scale.factor, []), interval: '', unit: scale.unit };
	}
	const scale = scaleFor(unit, Math.max(Math.abs(value), Math.abs(low), Math.abs(high)));
	const scaled = [low * scale.factor, high * scale.factor] as const;
	const [below, above] = [value - low, high - value];
	const isSymmetric = Math.abs(above - below) <= 0.02 * (above + below);
	const half = ((above + below) / 2) * scale.factor;
	return {
		value: formatEstimate(value * scale.factor, scaled),
		interval: isSymmetric && half > 0 ? `± ${formatNumber(half, 2)}` : formatInterval(scaled),
		unit: scale.unit,
	};
}

/** Results for several directions. */
export interface ResultTable {
	configurations: string[];
	rows: { symbol: string; title: string; of: IdentifiedQuantity[] }[];
}

/**
 * A column per direction, if every symbol has a value for each. The titles agree up to a comma, followed by the
 * direction.
 */
export function configurationTable(quantities: readonly IdentifiedQuantity[]): ResultTable | null {
	const bySymbol = new Map<string, IdentifiedQuantity[]>();
	for (const one of quantities) bySymbol.set(one.symbol, [...(bySymbol.get(one.symbol) ?? []), one]);
	const rows = [...bySymbol].map(([symbol, of]) => {
		const parts = of[0]!.title.split(', ');
		const begins = parts.map((_, i) => parts.slice(0, i).join(', ')).findLast((begin) => of.every(({ title }) => title.startsWith(`${begin}, `)));
		return { symbol, title: begins ?? '', of };
	});
	const [configurations = [], ...others] = rows.map(({ title, of }) => of.map((one) => one.title.slice(title.length + 2)));
	const whole = configurations.length > 2 && others.length > 0 && others.every((more) => more.join('\n') === configurations.join('\n'));
	return whole && quantities.every((one) => !one.ci95) ? { configurations, rows } : null;
}

/** A part of a campaign with its quantities and figures. */
export interface Part extends CampaignPart {
	quantities: IdentifiedQuantity[];
	figures: Identification['figures'];
}

/** The summary ends with a line per part; the remaining text is the lead. */
export function campaignParts({ summary, quantities, figures, parts = [] }: Pick<Identification, 'summary' | 'quantities' | 'figures' | 'parts'>): { lead: string; parts: Part[] } {
	const lines = summary.split('\n');
	return {
		lead: parts.length > 0 ? lines.slice(0, lines.length - parts.length).join(' ') : summary,
		parts: parts.map((part) => ({
			...part,
			quantities: quantities.filter(({ name }) => name.startsWith(`${part.id}.`)).map((one) => ({ ...one, title: one.title.slice(part.title.length + 2) })),
			figures: figures.filter(({ name }) => name.startsWith(`${part.id}.`)),
		})),
	};
}
