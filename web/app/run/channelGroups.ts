import { label } from '../format/label';
import type { Channel } from '../api/types';
import type { Curve } from '../plot/chart';
import { curveStyle } from '../plot/colour';

/** Channels with the same unit share a plot. */
export interface ChannelGroup {
	unit: string;
	title: string;
	names: string[];
	curves: Curve[];
}

export const COUNTERS = new Set(['time_s', 'segment', 'repeat']);
/**
 * Motor torque during an active run, measured and as predicted by the bench's last model. It is small compared with the
 * link torque, so it has its own plot.
 */
export const MODEL = 'model';
export const MOTOR_TORQUES = ['motor_torque_nm', 'model_torque_nm'];
/** Angles of a stage: a few mrad, which the rotation of a shaft would reduce to flat lines. */
const STAGE = 'stage';
/** The quantity of a unit, in the usual order of interest. */
const QUANTITIES = new Map([
	['rad/s', 'velocity'],
	[MODEL, 'motor torque'],
	['Nm', 'torque'],
	['A', 'current'],
	['°C', 'temperature'],
	['rad', 'position'],
	[STAGE, 'stage angle'],
	['m/s', 'velocity'],
	['N', 'force'],
	['m', 'position'],
]);
const ORDER = [...QUANTITIES.keys()];

/** `shown`: the displayed unit of a unit; the group keeps the unit of its channels. `model`: name of the model. */
export function channelGroups(channels: readonly Channel[], shown = (unit: string) => unit, model = MODEL): ChannelGroup[] {
	const byUnit = new Map<string, string[]>();
	for (const channel of channels) {
		if (COUNTERS.has(channel.name)) continue;
		const unit = MOTOR_TORQUES.includes(channel.name) ? MODEL : /^stage_.*_rad$/.test(channel.name) ? STAGE : label(channel.name, channel.unit).unit;
		byUnit.set(unit, [...(byUnit.get(unit) ?? []), channel.name]);
	}
	const place = (unit: string) => (ORDER.includes(unit) ? ORDER.indexOf(unit) : ORDER.length);
	return [...byUnit].map(([unit, names]) => makeGroup(unit, names, shown, model)).sort((a, b) => place(a.unit) - place(b.unit));
}

function makeGroup(unit: string, names: string[], read: (unit: string) => string, model: string): ChannelGroup {
	const titles = unit === MODEL ? ['measured', model] : names.map((name) => label(name).title);
	// The title of the shifts of a stage lists its axes.
	const title = (names[0]?.startsWith('stage_') && unit !== STAGE ? null : QUANTITIES.get(unit)) ?? titles.join(', ');
	const shown = unit === MODEL ? 'Nm' : unit === STAGE ? 'rad' : read(unit);
	const curves = titles.map((title, i) => ({ label: title, unit: shown, mark: 'line' as const, ...curveStyle(i) }));
	return { unit, title: unit ? `${title} [${shown}]` : title, names, curves };
}
