import { label } from '../format/label';
import type { Channel } from '../api/types';
import type { Curve } from '../plot/chart';
import { curveStyle } from '../plot/colour';

/** Channels that share a unit share a plot. */
export interface Group {
	unit: string;
	title: string;
	names: string[];
	curves: Curve[];
}

export const COUNTERS = new Set(['time_s', 'segment', 'repeat']);
/** What the daemon tells beside a run that is on: the torque of the motor, measured and as the bench's last model has it. Small beside what the link carries, so a plot of its own. */
export const MODEL = 'model';
export const TOLD = ['motor_torque_nm', 'model_torque_nm'];
/** Angles by which a stage is moved: some mrad, which the turns of a shaft would make flat lines of. */
const STAGE = 'stage';
/** What a unit measures, in the order in which people look at it. */
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

/** `shown`: in which unit a unit is read; the group keeps the unit of its channels. `model`: what the model is called. */
export function groupsOf(channels: readonly Channel[], shown = (unit: string) => unit, model = MODEL): Group[] {
	const byUnit = new Map<string, string[]>();
	for (const channel of channels) {
		if (COUNTERS.has(channel.name)) continue;
		const unit = TOLD.includes(channel.name) ? MODEL : /^stage_.*_rad$/.test(channel.name) ? STAGE : label(channel.name, channel.unit).unit;
		byUnit.set(unit, [...(byUnit.get(unit) ?? []), channel.name]);
	}
	const place = (unit: string) => (ORDER.includes(unit) ? ORDER.indexOf(unit) : ORDER.length);
	return [...byUnit].map(([unit, names]) => makeGroup(unit, names, shown, model)).sort((a, b) => place(a.unit) - place(b.unit));
}

function makeGroup(unit: string, names: string[], read: (unit: string) => string, model: string): Group {
	const titles = unit === MODEL ? ['measured', model] : names.map((name) => label(name).title);
	// Where a stage stands is told by its ways.
	const title = (names[0]?.startsWith('stage_') && unit !== STAGE ? null : QUANTITIES.get(unit)) ?? titles.join(', ');
	const shown = unit === MODEL ? 'Nm' : unit === STAGE ? 'rad' : read(unit);
	const curves = titles.map((title, i) => ({ label: title, unit: shown, mark: 'line' as const, ...curveStyle(i) }));
	return { unit, title: unit ? `${title} [${shown}]` : title, names, curves };
}
