import type { IdentifiedQuantity, Parameter } from '../api/types';

/**
 * Quantities of the run's result that a parameter of the model estimates too: the same name and unit, else the mean of
 * both directions and each direction. A Stribeck rise is no breakaway friction of a direction, although both are τ_s.
 */
export function sameQuantities({ name, unit }: Pick<Parameter, 'name' | 'unit'>, quantities: readonly IdentifiedQuantity[]): IdentifiedQuantity[] {
	const found = (...names: string[]) => quantities.filter((one) => names.includes(one.name) && one.unit === unit);
	const same = found(name);
	return same.length > 0 || name === 'tau_s' ? same : found(`${name}_mean`, `${name}_positive`, `${name}_negative`);
}
