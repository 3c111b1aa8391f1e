import { expect, it } from 'vitest';
import { quantityTrends } from './quantityTrends';

const figure = (value: number, half: number) => ({ name: 'tau_c', symbol: 'τ_c', title: 'Coulomb friction', unit: 'Nm', value, ci95: [value - half, value + half] });
const plain = (unit: string) => ({ factor: 1, unit });

it('sets a figure behind those of earlier runs, and says whether it differs from the last of them', () => {
	const earlier = [
		{ run: 4, created_at: '2026-11-20T16:31:00', holds: false, quantities: [figure(0.03, 0.001)] },
		{ run: 3, created_at: '2026-11-19T16:31:00', holds: false, quantities: [] },
		{ run: 2, created_at: '2026-11-18T16:31:00', holds: false, quantities: [figure(0.028, 0.002)] },
	];
	const [found, ...others] = quantityTrends(5, [figure(0.035, 0.001), { ...figure(1, 1), name: 'new' }], earlier, plain);
	expect(others).toEqual([]);
	expect(found!.dots.map(({ run }) => run)).toEqual([2, 4, 5]);
	expect(found!.dots[0]!.ends[0]).toBe(0);
	expect(found!.dots[2]!.ends[1]).toBe(1);
	expect([found!.change, found!.differs]).toEqual(['+5.0 ± 1.4 mNm', true]);
	expect(found!.text.split('\n').at(-1)).toBe('#5 35.0 ± 1.0 mNm');
	expect(quantityTrends(5, [figure(0.0305, 0.001)], earlier, plain)[0]).toMatchObject({ change: '+0.50 ± 1.4 mNm', differs: false });
	expect(quantityTrends(5, [{ ...figure(0.0305, 0), ci95: null }], earlier, plain)[0]).toMatchObject({ change: '+500 µNm', differs: null });
});

it('says nothing of a change where the run before has no such figure', () => {
	const [found] = quantityTrends(5, [figure(0.035, 0.001)], [{ run: 4, created_at: '', holds: false, quantities: [] }, { run: 3, created_at: '', holds: false, quantities: [figure(0.03, 0.001)] }], plain);
	expect([found!.change, found!.differs, found!.dots.length]).toEqual(['', null, 2]);
});

it('tells changes against the run that is applied to the bench', () => {
	const of = (run: number, value: number, holds: boolean) => ({ run, created_at: '', holds, quantities: [figure(value, 0.001)] });
	const [found] = quantityTrends(5, [figure(0.035, 0.001)], [of(4, 0.0349, false), of(3, 0.03, true)], plain);
	expect([found!.change, found!.differs]).toEqual(['+5.0 ± 1.4 mNm', true]);
});
