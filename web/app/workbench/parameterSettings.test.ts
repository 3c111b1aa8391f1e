import { expect, it } from 'vitest';
import type { Fit } from '../api/types';
import { isNonlinear, readDraft, settingDraft, withSetting } from './parameterSettings';

const OF = { effect: 'stribeck', name: 'omega_s' };

it('reads a draft in the displayed unit', () => {
	const draft = { ...settingDraft(undefined, 0.0286, 1000), min: '20', max: '−5' };
	expect(draft.fixed).toBe('28.6');
	expect(readDraft(draft, OF, 1000)).toEqual({ ...OF, min: 0.02, max: -0.005 });
	expect(readDraft({ ...draft, isFixed: true }, OF, 1000)).toEqual({ ...OF, fixed: 0.0286, min: 0.02, max: -0.005 });
	expect(readDraft({ ...draft, min: '', max: '' }, OF, 1000)).toBeNull();
	expect(readDraft({ ...draft, max: 'wide' }, OF, 1000)).toEqual({ invalid: 'max' });
	expect(readDraft({ ...draft, isFixed: true, fixed: ' ' }, OF, 1000)).toEqual({ invalid: 'fixed' });
});

it('starts with the present setting', () => {
	expect(settingDraft({ ...OF, fixed: 0.03, min: 0 }, 0.03, 1000)).toEqual({ isFixed: true, fixed: '30', min: '0', max: '', start: '' });
});

it('replaces the setting of one parameter', () => {
	const [one, other] = [{ ...OF, min: 0 }, { effect: 'coulomb', name: 'tau_c', fixed: 1 }];
	expect(withSetting([one, other], OF, { ...OF, max: 2 })).toEqual([other, { ...OF, max: 2 }]);
	expect(withSetting([one, other], OF, null)).toEqual([other]);
});

it('knows the parameters that the fit searches for', () => {
	const fit = { terms: [{ effect: 'stribeck', linear: [1], names: ['tau_s', 'omega_s'] }] } as unknown as Fit;
	expect([isNonlinear(fit, OF), isNonlinear(fit, { ...OF, name: 'tau_s' }), isNonlinear(fit, { effect: 'inertia', name: 'j' })]).toEqual([true, false, false]);
});
