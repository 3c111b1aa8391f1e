import { axisTitle, label } from '../format/label';
import { speedScale, spokenSpeeds } from '../format/speed';
import type { Scale } from '../format/number';

const KEPT = 'jointbench.speed';

/** Whether speeds are read in rad/s or in rpm, kept by the browser. What is sent and stored stays in rad/s. */
class Speed {
	rpm = $state(localStorage.getItem(KEPT) === 'rpm');

	toggle(): void {
		this.rpm = !this.rpm;
		localStorage.setItem(KEPT, this.rpm ? 'rpm' : 'rad/s');
	}

	scale(unit: string): Scale {
		return speedScale(unit, this.rpm);
	}

	/** A sentence with its speeds in the unit that is shown. */
	said(sentence: string): string {
		return spokenSpeeds(sentence, this.rpm);
	}

	/** The title of an axis in the unit that is shown. */
	title(column: string, unit?: string | null): string {
		return axisTitle(column, this.scale(label(column, unit).unit).unit);
	}
}

export const speed = new Speed();
