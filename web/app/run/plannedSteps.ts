import type { Preview, Run, RunEvent } from '../api/types';
import { label, withMinusSigns } from '../format/label';
import { tickText } from '../plot/ticks';
import type { Scale } from '../format/number';
import type { BackdropLine } from '../plot/backdrop';
import type { View } from '../plot/gestures';

/** A step as executed in the run. */
export interface ExecutedStep {
	/** Its position in the plan, from 0. */
	step: number;
	label: string;
	at_s: number;
	/** Start of the next step, or end of the run. */
	to_s: number;
}

/** The steps of a run in the order of their start; a step that was repeated after a pause occurs twice. */
export function executedSteps(events: readonly Pick<RunEvent, 'kind' | 'at_s' | 'data'>[], end_s: number): ExecutedStep[] {
	const started = events.filter(({ kind }) => kind === 'step_started');
	return started.map(({ at_s, data }, i) => ({
		step: Number(data['step'] ?? i),
		label: withMinusSigns(String(data['label'] ?? '')),
		at_s,
		to_s: started[i + 1]?.at_s ?? Math.max(at_s, end_s),
	}));
}

/** [s] Displayed time on each side of a single time. */
const AROUND_S = 2;
/** Displayed margin before and after a step, as a fraction of its duration. */
const MARGIN = 0.05;

/** Time range around a time of the run. */
export const aroundMoment = (at_s: number): View => [at_s - AROUND_S, at_s + AROUND_S];

export function aroundStep({ at_s, to_s }: Pick<ExecutedStep, 'at_s' | 'to_s'>): View {
	const more = MARGIN * (to_s - at_s) || AROUND_S;
	return [at_s - more, to_s + more];
}

type SetPointCurve = { x: number[]; y: number[] };

/**
 * A planned set-point on the clock of the run: each step from its actual start. A step lasts for its planned time, or
 * until the start of the next one.
 */
export function setPointCurve(plan: Pick<Preview, 'steps'>, time_s: readonly number[], values: readonly number[], made: readonly ExecutedStep[]): SetPointCurve {
	const begins = plan.steps.reduce<number[]>((list, { duration_s }) => [...list, list.at(-1)! + duration_s], [0]);
	const course: SetPointCurve = { x: [], y: [] };
	for (const { step, at_s, to_s } of made) {
		const [from, to] = [begins[step], begins[step + 1]];
		if (from === undefined || to === undefined) continue;
		const inside = time_s.flatMap((t, i) => (t > from + 1e-9 && t < to - 1e-9 ? [[t, values[i]!] as const] : []));
		const corners = [[from, valueAt(time_s, values, from, 'after')] as const, ...inside, [to, valueAt(time_s, values, to, 'before')] as const];
		for (const [t, value] of corners) {
			course.x.push(Math.min(to_s, at_s + t - from));
			course.y.push(value);
		}
	}
	return course;
}

/** At a jump a set-point has two corners at one time: the value before or after it. */
function valueAt(time_s: readonly number[], values: readonly number[], at: number, side: 'before' | 'after'): number {
	const close = (t: number) => Math.abs(t - at) < 1e-9;
	const corner = side === 'after' ? time_s.findLastIndex(close) : time_s.findIndex(close);
	if (corner >= 0) return values[corner]!;
	const next = time_s.findIndex((t) => t > at);
	if (next <= 0) return (next === 0 ? values[0] : values.at(-1)) ?? 0;
	const share = (at - time_s[next - 1]!) / (time_s[next]! - time_s[next - 1]!);
	return values[next - 1]! + share * (values[next]! - values[next - 1]!);
}

/**
 * Quantities with a set-point in the plan, each with the channel that records its command. If a run has that channel,
 * the plan adds nothing.
 */
const PLANNED = [
	['motor_velocity_rad_s', 'velocity_setpoint_rad_s'],
	['brake_current_a', 'brake_current_command_a'],
] as const;

const SET_POINT = 'set point';

/** Set-points of the plan for these channels, in the displayed unit. */
export function setPointLines(plan: Preview | undefined, made: readonly ExecutedStep[], names: readonly string[], { factor }: Scale): BackdropLine[] {
	if (!plan || made.length === 0) return [];
	return PLANNED.filter(([name, kept]) => names.includes(name) && !names.includes(kept)).flatMap(([name]) => {
		const { x, y } = setPointCurve(plan, plan.setpoints.time_s, plan.setpoints[name], made);
		if (y.every((value) => value === 0)) return [];
		return [{ label: SET_POINT, valueText: '', stroke: '--soft', dash: [2, 2], levels: [], x, y: y.map((value) => value * factor) }];
	});
}

/** Colour and dash of the limits of a plot: they never differ only in colour. */
const LIMIT_STYLES: [string, number[]][] = [
	['--bad', [8, 3]],
	['--warn', [10, 3, 2, 3]],
	['--oi-purple', [3, 4]],
];

/**
 * Limits of the bench at the time of the run for these channels, each once. They apply to magnitudes; a temperature has
 * only an upper limit.
 */
export function limitLines({ provenance }: Pick<Run, 'provenance'>, names: readonly string[], { factor, unit }: Scale): BackdropLine[] {
	const limits = (provenance['limits'] ?? {}) as Record<string, unknown>;
	return names.filter((name) => typeof limits[name] === 'number').map((name, i) => {
		const level = Number(limits[name]) * factor;
		const oneSided = name.endsWith('_c');
		const [stroke, dash] = LIMIT_STYLES[i % LIMIT_STYLES.length]!;
		return { label: names.length > 1 ? `limit, ${label(name).title}` : 'limit', valueText: `${oneSided ? '' : '± '}${tickText(level)} ${unit}`, stroke, dash, levels: oneSided ? [level] : [level, -level], x: [], y: [] };
	});
}
