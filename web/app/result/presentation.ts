import type { CampaignPart, Identification, IdentifiedQuantity, LimitCheck } from '../api/types';
import { type Scale, formatAllDigits, formatInterval, formatEstimate, formatNumber, prefixSize, scaleFor } from '../format/number';
import type { StatusLabel } from '../ui/states';

const VERDICTS: Record<Identification['verdict'], StatusLabel> = {
	identified: { label: 'IDENTIFIED', icon: '✓', tone: 'good' },
	identified_with_warning: { label: 'IDENTIFIED WITH A WARNING', icon: '⚠', tone: 'warn' },
	inconclusive: { label: 'INCONCLUSIVE', icon: '◔', tone: 'warn' },
	failed: { label: 'FAILED', icon: '✕', tone: 'bad' },
};

export const verdictLabel = (verdict: Identification['verdict']) => VERDICTS[verdict];

const LIMIT_OUTCOMES: Record<LimitCheck['outcome'], StatusLabel> = {
	pass: { label: 'PASS', icon: '✓', tone: 'good' },
	marginal: { label: 'MARGINAL', icon: '◔', tone: 'warn' },
	inconclusive: { label: 'INCONCLUSIVE', icon: '◔', tone: 'warn' },
	fail: { label: 'FAIL', icon: '✕', tone: 'bad' },
};

/** Outcome of a limit, or of all limits of a run. */
export const limitLabel = (outcome: LimitCheck['outcome']) => LIMIT_OUTCOMES[outcome];

type Verdict = StatusLabel & {
	/** The result without the label and without the parts of a campaign. */
	text: string;
};

/** The verdict in a word. If the result was compared with a data sheet, the word is the outcome of that. */
export function resultVerdict({ verdict, passes, summary, lead, parts = [] }: Pick<Identification, 'verdict' | 'passes' | 'summary' | 'lead' | 'parts'>): Verdict {
	if (verdict === 'identified' && passes != null) {
		const outcome: StatusLabel = passes ? { label: 'PASS', icon: '✓', tone: 'good' } : { label: 'OUT OF TOLERANCE', icon: '✕', tone: 'bad' };
		return { ...outcome, text: lead ?? summary };
	}
	return { ...VERDICTS[verdict], text: parts.length > 0 ? (lead ?? summary) : summary };
}

/** A value without an interval. A count has no decimals. */
export const formatWithoutInterval = (value: number, unit: string, digits = 4): string => (unit === '' && Number.isInteger(value) ? formatAllDigits(value) : formatNumber(value, digits));

/**
 * A quantity with one prefix for value and interval: `32.1 ± 0.4 µNm·s/rad`; an asymmetric interval is given by its
 * ends.
 */
export function formatResult(of: Pick<IdentifiedQuantity, 'value' | 'unit' | 'ci95'>, shown: Scale = { factor: 1, unit: of.unit }): { value: string; interval: string; unit: string } {
	const [value, unit] = [of.value * shown.factor, shown.unit];
	const [low, high] = (of.ci95 ?? []).map((end) => end * shown.factor);
	if (low === undefined || high === undefined) {
		const scale = scaleFor(unit, value);
		return { value: formatWithoutInterval(value * scale.factor, scale.unit), interval: '', unit: scale.unit };
	}
	const scale = scaleFor(unit, prefixSize(value, [low, high]));
	const scaled = [low * scale.factor, high * scale.factor] as const;
	const [below, above] = [value - low, high - value];
	const isSymmetric = Math.abs(above - below) <= 0.02 * (above + below);
	const half = ((above + below) / 2) * scale.factor;
	return {
		value: formatEstimate(value * scale.factor, scaled),
		interval: isSymmetric && half > 0 ? `± ${formatNumber(half, 2, 1e-6)}` : formatInterval(scaled),
		unit: scale.unit,
	};
}

/** Title of a quantity without its configuration: equal in all runs, also where a title contains a measured speed. */
export const baseTitle = ({ base_title, title }: Pick<IdentifiedQuantity, 'base_title' | 'title'>): string => base_title ?? title;

/** Results for several directions, methods or speeds. */
export interface ResultTable {
	/** What the rows differ in. */
	head: 'direction' | 'configuration';
	configurations: string[];
	/** Two quantities may share a symbol, such as τ_s in volts and newton metres. */
	rows: { key: string; symbol: string; title: string; of: IdentifiedQuantity[] }[];
}

/** A row per configuration, for at least two quantities with a value for each of at least two configurations. */
export function configurationTable(quantities: readonly IdentifiedQuantity[]): ResultTable | null {
	const byTitle = new Map<string, IdentifiedQuantity[]>();
	for (const one of quantities.filter(({ configuration }) => configuration)) {
		const key = `${one.base_symbol ?? one.symbol} ${baseTitle(one)}`;
		byTitle.set(key, [...(byTitle.get(key) ?? []), one]);
	}
	const groups = [...byTitle];
	const longest = groups.toSorted(([, a], [, b]) => b.length - a.length)[0]?.[1] ?? [];
	const nameOf = ({ direction, configuration }: IdentifiedQuantity) => direction ?? configuration ?? '';
	const configurations = longest.map(nameOf);
	const hasEach = (of: IdentifiedQuantity[]) => of.length === configurations.length && of.every((one, i) => nameOf(one) === configurations[i]);
	const rows = groups.filter(([, of]) => hasEach(of)).map(([key, of]) => ({ key, symbol: of[0]!.base_symbol ?? of[0]!.symbol, title: baseTitle(of[0]!), of }));
	const head = longest.every(({ direction }) => direction) ? 'direction' : 'configuration';
	return configurations.length > 1 && rows.length > 1 ? { head, configurations, rows } : null;
}

/** A part of a campaign with its quantities and figures. */
export interface Part extends Omit<CampaignPart, 'quantities' | 'figures'> {
	quantities: IdentifiedQuantity[];
	figures: Identification['figures'];
}

/** A quantity below the title of its part does not repeat it. */
const withoutPart = (one: IdentifiedQuantity): IdentifiedQuantity => ({ ...one, title: [baseTitle(one), one.configuration].filter(Boolean).join(', ') });

export function campaignParts({ quantities, figures, parts = [] }: Pick<Identification, 'quantities' | 'figures' | 'parts'>): Part[] {
	return parts.map((part) => ({
		...part,
		quantities: quantities.filter(({ name }) => part.quantities.includes(name)).map(withoutPart),
		figures: figures.filter(({ name }) => part.figures.includes(name)),
	}));
}
