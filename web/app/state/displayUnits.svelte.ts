import { type Angle, angleScale, parseAngle } from '../format/angle';
import { axisTitle, label } from '../format/label';
import { speedScale, withDisplayedSpeeds } from '../format/speed';
import type { Scale } from '../format/number';
import { router } from './router.svelte';

const SPEED_KEY = 'jointbench.speed';
const ANGLE_KEY = 'jointbench.angle';

/**
 * Display units of speeds and angles: from the address, or from this browser. Sent and stored values stay in rad/s and
 * rad.
 */
class DisplayUnits {
	private storedSpeed = $state(localStorage.getItem(SPEED_KEY));
	rpm = $derived((router.query.get('speed') ?? this.storedSpeed) === 'rpm');

	toggleSpeed(): void {
		localStorage.setItem(SPEED_KEY, (this.storedSpeed = this.rpm ? 'rad/s' : 'rpm'));
		router.set({ speed: this.storedSpeed });
	}

	private storedAngle = $state(localStorage.getItem(ANGLE_KEY));
	angle: Angle = $derived(parseAngle(router.query.get('angle') ?? this.storedAngle));

	setAngle(angle: Angle): void {
		localStorage.setItem(ANGLE_KEY, (this.storedAngle = angle));
		router.set({ angle });
	}

	scale(unit: string): Scale {
		return unit === 'rad/s' ? speedScale(unit, this.rpm) : angleScale(unit, this.angle);
	}

	/** A sentence with its speeds in the displayed unit. */
	withSpeeds(sentence: string): string {
		return withDisplayedSpeeds(sentence, this.rpm);
	}

	/** The title of an axis in the displayed unit. */
	title(column: string, unit?: string | null): string {
		return axisTitle(column, this.scale(label(column, unit).unit).unit);
	}
}

export const displayUnits = new DisplayUnits();
