import { expect, it } from 'vitest';
import { sameQuantities } from './runResult';

const quantity = (name: string, unit = 'Nm') => ({ name, symbol: '', title: name, unit, value: 1 });

it('finds what the run itself has identified for a parameter', () => {
	const friction = ['tau_c', 'tau_c_positive', 'tau_c_negative', 'tau_c_difference'].map((name) => quantity(name));
	expect(sameQuantities({ name: 'tau_c', unit: 'Nm' }, friction).map(({ name }) => name)).toEqual(['tau_c']);
	expect(sameQuantities({ name: 'tau_c', unit: 'Nm' }, friction.slice(1)).map(({ name }) => name)).toEqual(['tau_c_positive', 'tau_c_negative']);
	expect(sameQuantities({ name: 'c_v', unit: 'Nm·s/rad' }, [quantity('c_v', 'V')])).toEqual([]);
	expect(sameQuantities({ name: 'tau_s', unit: 'Nm' }, [quantity('tau_s_positive')])).toEqual([]);
});
