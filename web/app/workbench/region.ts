/** A stretch of one axis, as the address carries it: `motor_velocity_rad_s:3.2:8`. */
export interface Stretch {
	axis: string;
	from: number;
	to: number;
}

export function readStretch(text: string | null): Stretch | null {
	const [axis = '', from = '', to = ''] = text?.split(':') ?? [];
	const stretch = { axis, from: Number(from), to: Number(to) };
	const whole = axis !== '' && from !== '' && to !== '' && Number.isFinite(stretch.from) && Number.isFinite(stretch.to);
	return whole ? stretch : null;
}

export function writeStretch({ axis, from, to }: Stretch): string {
	return [axis, Number(from.toPrecision(6)), Number(to.toPrecision(6))].join(':');
}

export type Strength = 'STRONG' | 'WEAK' | "CAN'T TELL APART";

/** One word for the evidence; the figures stand beside it. */
export function strength(suggestion: { error_reduction: number; p_value: number; confounded_with: readonly string[] }): Strength {
	if (suggestion.confounded_with.length > 0) return "CAN'T TELL APART";
	return suggestion.p_value < 0.01 && suggestion.error_reduction >= 0.05 ? 'STRONG' : 'WEAK';
}
