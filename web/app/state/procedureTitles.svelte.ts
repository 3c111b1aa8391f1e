import { api } from '../api/client';
import type { ProcedureParameter } from '../api/types';
import { axisTitle, idText } from '../format/label';
import { fieldUnit, inFieldUnit } from '../overview/parameterValues';

/** Titles of the procedures and of their settings, as in the form that starts them. */
class ProcedureTitles {
	private titles: Record<string, string> = $state.raw({ import: 'Import' });
	private parameters: Record<string, readonly ProcedureParameter[]> = $state.raw({});
	private isRequested = false;

	/** Requests the titles once; a failed request is repeated with the next contact. */
	async load(): Promise<void> {
		if (this.isRequested) return;
		this.isRequested = true;
		try {
			const procedures = await api.procedures();
			this.titles = { ...this.titles, ...Object.fromEntries(procedures.map(({ id, title }) => [id, title])) };
			this.parameters = Object.fromEntries(procedures.map(({ id, parameters }) => [id, parameters]));
		} catch {
			this.isRequested = false;
		}
	}

	/** A setting with its unit, as in the form; the name in words for any other fact of a run. */
	setting(procedure: string, name: string): string {
		const field = this.field(procedure, name);
		if (!field) return axisTitle(name);
		const unit = fieldUnit(field);
		return [field.title, unit && `[${unit}]`].filter(Boolean).join(' ');
	}

	/** Settings in the units of the form. */
	inFieldUnits(procedure: string, settings: Record<string, unknown>): Record<string, unknown> {
		return Object.fromEntries(Object.entries(settings).map(([name, value]) => [name, inFieldUnit(this.field(procedure, name), value)]));
	}

	private field(procedure: string, name: string): ProcedureParameter | undefined {
		return this.parameters[procedure]?.find((one) => one.name === name);
	}

	/** The id in words until the titles are there, and for a procedure that the daemon no longer has. */
	of(id: string): string {
		return this.titles[id] ?? idText(id);
	}
}

export const procedureTitles = new ProcedureTitles();
