import { expect, it } from 'vitest';
import { angleScale, hasAngle, parseAngle } from './angle';

it('scales angles, compliances and stiffnesses, and nothing else', () => {
	expect(angleScale('rad', 'arcmin').factor).toBeCloseTo(3437.75, 2);
	expect(angleScale('rad', 'arcsec').factor).toBeCloseTo(206264.8, 1);
	const [k, c] = [angleScale('Nm/rad', 'arcmin'), angleScale('rad/Nm', 'arcmin')];
	expect(k.factor * c.factor).toBeCloseTo(1, 12);
	expect([k.unit, c.unit]).toEqual(['Nm/arcmin', 'arcmin/Nm']);
	for (const unit of ['rad/s', 'Nm·s/rad', 'Nm', '']) expect(angleScale(unit, '°')).toEqual({ factor: 1, unit });
	expect(angleScale('rad', 'rad')).toEqual({ factor: 1, unit: 'rad' });
});

it('reads what the address says, else rad', () => {
	expect([parseAngle('arcsec'), parseAngle('turns'), parseAngle(null)]).toEqual(['arcsec', 'rad', 'rad']);
	expect([hasAngle(['Nm', 'rad/Nm']), hasAngle(['Nm', 'rad/s'])]).toEqual([true, false]);
});
