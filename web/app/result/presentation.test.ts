import { expect, it } from 'vitest';
import { resultVerdict, campaignParts, formatResult, configurationTable } from './presentation';

it('says a quantity with one prefix for value and interval', () => {
	expect(formatResult({ value: 3.2e-5, unit: 'Nm·s/rad', ci95: [3.16e-5, 3.24e-5] })).toEqual({ value: '32.00', interval: '± 0.40', unit: 'µNm·s/rad' });
	expect(formatResult({ value: 0.007919, unit: 'V/(°/s)', ci95: [0.007866, 0.007972] }).interval).toBe('± 0.000053');
	expect(formatResult({ value: 0.000_95, unit: 'Nm', ci95: [0.0008, 0.0011] })).toEqual({ value: '0.95', interval: '± 0.15', unit: 'mNm' });
	expect(formatResult({ value: 0, unit: 'Nm', ci95: [-0.002, 0.001] })).toMatchObject({ value: '0', unit: 'mNm' });
	expect(formatResult({ value: 41_230, unit: 'Nm/rad', ci95: [40_920, 41_540] })).toEqual({ value: '41.23', interval: '± 0.31', unit: 'kNm/rad' });
});

it('says an uneven interval by its ends, and none where there is none', () => {
	expect(formatResult({ value: 0.0506, unit: 'rad/s', ci95: [0.047, 0.0561] }).interval).toBe('[47.0, 56.1]');
	expect(formatResult({ value: 7, unit: '', ci95: null })).toEqual({ value: '7', interval: '', unit: '' });
	expect(formatResult({ value: 0.9987, unit: '' }).value).toBe('0.9987');
});

it('sets what was found for several ways side by side, and nothing else', () => {
	const made = (symbol: string, what: string) => ['none', 'Coulomb, interpolated', 'observer'].map((way, i) => ({ name: `${symbol}${i}`, symbol, title: `${what}, ${way}`, base_title: what, configuration: way, unit: 'rad', value: i }));
	const found = [...made('ρ_1', 'Sum of the errors'), ...made('ρ_1/ρ_10', 'Sum of the errors, share of none')];
	const table = configurationTable(found);
	expect([table?.head, table?.configurations]).toEqual(['configuration', ['none', 'Coulomb, interpolated', 'observer']]);
	expect(table?.rows.map(({ title, of }) => [title, ...of.map((one) => one.value)])).toEqual([
		['Sum of the errors', 0, 1, 2],
		['Sum of the errors, share of none', 0, 1, 2],
	]);
	expect(configurationTable(found.slice(1))).toBeNull();
	expect(configurationTable([...found, { ...found[0]!, name: 'gain', symbol: 'κ', base_title: 'Gain' }])).toEqual(table);
	const directions = (symbol: string, what: string) =>
		([['⁺', 'positive'], ['⁻', 'negative']] as const).map(([sign, direction]) => ({ name: `${symbol}_${direction}`, symbol: `${symbol}${sign}`, base_symbol: symbol, title: `${what}, ${direction} direction`, base_title: what, configuration: `${direction} direction`, direction, unit: 'Nm', value: 1 }));
	const both = configurationTable([...directions('τ_c', 'Coulomb friction'), ...directions('c_v', 'Viscous friction')]);
	expect([both?.head, both?.configurations]).toEqual(['direction', ['positive', 'negative']]);
	expect(both?.rows.map(({ symbol, title }) => [symbol, title])).toEqual([['τ_c', 'Coulomb friction'], ['c_v', 'Viscous friction']]);
	const inVoltsAndNm = configurationTable([...directions('τ_s', 'Breakaway friction'), ...directions('τ_s', 'Breakaway friction (motor)')]);
	expect(new Set(inVoltsAndNm?.rows.map(({ key }) => key)).size).toBe(2);
	expect(configurationTable([{ ...found[0]!, name: 'delay', symbol: 't_d', configuration: undefined }, ...found])).toEqual(table);
});

it('takes a campaign apart into its parts, and nothing else', () => {
	const k = { name: 'stiffness.k', symbol: 'k', title: 'Stiffness: Stiffness of the joint', base_title: 'Stiffness of the joint', unit: 'Nm/rad', value: 678 };
	const positive = { ...k, name: 'stiffness.k_positive', title: 'Stiffness: Stiffness of the joint, positive direction', configuration: 'positive direction' };
	const axis = { label: 'torque', unit: 'Nm' };
	const loop = { name: 'stiffness.torsion_over_torque', title: 'Torsion over torque', form: 'cartesian' as const, x: axis, y: axis, series: [] };
	const campaign = [
		{ id: 'stiffness', title: 'Stiffness', verdict: 'identified' as const, summary: 'It is 678 Nm/rad; it is: linear.', quantities: [k.name, positive.name], figures: [loop.name] },
		{ id: 'compensation', title: 'Friction compensation', verdict: 'failed' as const, summary: 'The run ended before this part.', quantities: [], figures: [] },
	];
	expect(campaignParts({ quantities: [k, positive], figures: [loop], parts: campaign })).toEqual([
		{ ...campaign[0], quantities: [{ ...k, title: 'Stiffness of the joint' }, { ...positive, title: 'Stiffness of the joint, positive direction' }], figures: [loop] },
		{ ...campaign[1], quantities: [], figures: [] },
	]);
	const stopped = { verdict: 'inconclusive', summary: 'The run did not complete (stopped):\nStiffness: linear.', lead: 'The run did not complete (stopped):', parts: campaign } as const;
	expect(resultVerdict(stopped).text).toBe('The run did not complete (stopped):');
	expect(campaignParts({ quantities: [], figures: [] })).toEqual([]);
});

it('takes the word from a result that was held against a data sheet', () => {
	const passed = { passes: true, summary: 'PASS: every way is consistent.', lead: 'every way is consistent.' };
	expect(resultVerdict({ verdict: 'identified', ...passed })).toMatchObject({ label: 'PASS', tone: 'good', text: 'every way is consistent.' });
	expect(resultVerdict({ verdict: 'identified_with_warning', ...passed })).toMatchObject({ label: 'IDENTIFIED WITH A WARNING', text: passed.summary });
	expect(resultVerdict({ verdict: 'identified', passes: false, summary: 'OUT OF TOLERANCE: X.', lead: 'X.' })).toMatchObject({ label: 'OUT OF TOLERANCE', tone: 'bad', text: 'X.' });
	expect(resultVerdict({ verdict: 'inconclusive', summary: 'UNDECIDED: X.' })).toMatchObject({ label: 'INCONCLUSIVE', text: 'UNDECIDED: X.' });
});
