import type { Fit, ParameterSetting } from '../api/types';
import { parseNumber } from '../format/number';

/** The values of the editor as text, in the displayed unit. */
export interface SettingDraft {
	isFixed: boolean;
	fixed: string;
	min: string;
	max: string;
	start: string;
}

type Named = Pick<ParameterSetting, 'effect' | 'name'>;

export const isOf = (one: Named, other: Named): boolean => one.effect === other.effect && one.name === other.name;

/** The settings with those of one parameter replaced; `null` frees it. */
export function withSetting(settings: readonly ParameterSetting[], of: Named, setting: ParameterSetting | null): ParameterSetting[] {
	return [...settings.filter((one) => !isOf(one, of)), ...(setting ? [setting] : [])];
}

/** Whether the fit searches for the parameter, so that a start value has an influence. */
export function isNonlinear(fit: Fit | undefined, { effect, name }: Named): boolean {
	const term = fit?.terms.find((one) => one.effect === effect);
	return term !== undefined && (term.names ?? []).indexOf(name) >= term.linear.length;
}

/** The editor starts with the present setting; the value is proposed for fixing. `factor`: from SI to the displayed unit. */
export function settingDraft(setting: ParameterSetting | undefined, value: number, factor: number): SettingDraft {
	const text = (number: number | null | undefined) => (number == null ? '' : String(Number((number * factor).toPrecision(12))));
	const proposed = String(Number((value * factor).toPrecision(4)));
	return { isFixed: setting?.fixed != null, fixed: text(setting?.fixed) || proposed, min: text(setting?.min), max: text(setting?.max), start: text(setting?.start) };
}

/** The setting of a draft, `null` for a free parameter, or the name of the field that is no number. */
export function readDraft(draft: SettingDraft, of: Named, factor: number): ParameterSetting | null | { invalid: keyof SettingDraft } {
	const setting: ParameterSetting = { effect: of.effect, name: of.name };
	for (const field of draft.isFixed ? (['fixed', 'min', 'max'] as const) : (['min', 'max', 'start'] as const)) {
		const text = draft[field].trim();
		if (text === '' && field !== 'fixed') continue;
		const value = parseNumber(text) / factor;
		if (!Number.isFinite(value)) return { invalid: field };
		setting[field] = value;
	}
	return Object.keys(setting).length > 2 ? setting : null;
}
