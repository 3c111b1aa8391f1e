import { axisTitle, label } from '../format/label';
import { speedScale, spokenSpeeds } from '../format/speed';
import type { Scale } from '../format/number';
import { router } from './router.svelte';

const KEPT = 'jointbench.speed';

/** Whether speeds are read in rad/s or in rpm: as the address says, or as this browser was left. What is sent and stored stays in rad/s. */
class Speed {
	private kept = $state(localStorage.getItem(KEPT));
	rpm = $derived((router.query.get('speed') ?? this.kept) === 'rpm');

	toggle(): void {
		localStorage.setItem(KEPT, (this.kept = this.rpm ? 'rad/s' : 'rpm'));
		router.set({ speed: this.kept });
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
