import { type Angle, angleScale, readAngle } from '../format/angle';
import { axisTitle, label } from '../format/label';
import { speedScale, spokenSpeeds } from '../format/speed';
import type { Scale } from '../format/number';
import { router } from './router.svelte';

const KEPT = 'jointbench.speed';
const ANGLE = 'jointbench.angle';

/**
 * Display units of speeds and angles: from the address, or from this browser. Sent and stored values stay in rad/s and
 * rad.
 */
class Speed {
	private kept = $state(localStorage.getItem(KEPT));
	rpm = $derived((router.query.get('speed') ?? this.kept) === 'rpm');

	toggle(): void {
		localStorage.setItem(KEPT, (this.kept = this.rpm ? 'rad/s' : 'rpm'));
		router.set({ speed: this.kept });
	}

	private keptAngle = $state(localStorage.getItem(ANGLE));
	angle: Angle = $derived(readAngle(router.query.get('angle') ?? this.keptAngle));

	setAngle(angle: Angle): void {
		localStorage.setItem(ANGLE, (this.keptAngle = angle));
		router.set({ angle });
	}

	scale(unit: string): Scale {
		return unit === 'rad/s' ? speedScale(unit, this.rpm) : angleScale(unit, this.angle);
	}

	/** A sentence with its speeds in the displayed unit. */
	said(sentence: string): string {
		return spokenSpeeds(sentence, this.rpm);
	}

	/** The title of an axis in the displayed unit. */
	title(column: string, unit?: string | null): string {
		return axisTitle(column, this.scale(label(column, unit).unit).unit);
	}
}

export const speed = new Speed();
