//! Limits and constants: from the description, from a data sheet, or not needed by the bench.

use super::Source;
use super::error::Collector;
use super::raw::{RawBench, RawConstants, RawLimits, RawTorsion};
use super::values::{flip, positive};
use jointbench_instrument::bench::JointConstants;
use jointbench_instrument::{Limits, TorsionLimit};
use toml::Spanned;

/// A source regulates around its set point, so a limit slightly above the rated current is valid.
const ABOVE_RATED: f64 = 1.1;

/// Source of values that the description does not contain.
pub struct Sheet {
    /// Values of a simulated bench.
    known: Option<(Limits, JointConstants)>,
    /// Ratings without a brake, and torque limit without a torque sensor or a brake.
    without_brake: Option<f64>,
    without_torque: Option<f64>,
}

impl Sheet {
    pub fn simulated(limits: Limits, constants: JointConstants) -> Self {
        Self { known: Some((limits, constants)), without_brake: None, without_torque: None }
    }

    pub fn of(raw: &RawBench) -> Self {
        let without_brake = raw.brake.is_none().then_some(0.0);
        let without_torque = without_brake.filter(|_| raw.torque_sensor.is_none());
        Self { known: None, without_brake, without_torque }
    }

    fn limit(&self, of: fn(&Limits) -> f64) -> Option<f64> {
        self.known.as_ref().map(|(limits, _)| of(limits))
    }

    fn constant(&self, of: fn(&JointConstants) -> f64) -> Option<f64> {
        self.known.as_ref().map(|(_, constants)| of(constants))
    }

    /// Reports every missing or wrong limit.
    pub fn limits(&self, raw: &RawBench, wrong: &mut Collector) -> Option<Limits> {
        let given = raw.limits.as_ref();
        let mut take = |name: &str, of: fn(&RawLimits) -> Option<&Spanned<f64>>, sheet: Option<f64>| {
            either(given.and_then(of), sheet, &format!("limits.{name}"), raw, wrong)
        };
        let velocity = self.limit(|l| l.motor_velocity_rad_s);
        let velocity = take("motor_velocity_rad_s", |r| r.motor_velocity_rad_s.as_ref(), velocity);
        let current = take("motor_current_a", |r| r.motor_current_a.as_ref(), self.limit(|l| l.motor_current_a));
        let torque = self.limit(|l| l.link_torque_nm).or(self.without_torque);
        let torque = take("link_torque_nm", |r| r.link_torque_nm.as_ref(), torque);
        let heat = take("temperature_c", |r| r.temperature_c.as_ref(), self.limit(|l| l.temperature_c));
        let brake = self.limit(|l| l.brake_current_a).or(self.without_brake);
        let brake = take("brake_current_a", |r| r.brake_current_a.as_ref(), brake);
        let power = self.limit(|l| l.brake_power_w).or(self.without_brake);
        let power = take("brake_power_w", |r| r.brake_power_w.as_ref(), power);
        Some(Limits {
            motor_velocity_rad_s: velocity?,
            motor_current_a: current?,
            link_torque_nm: torque?,
            temperature_c: heat?,
            brake_current_a: brake?,
            brake_power_w: power?,
        })
    }

    /// Reports every missing or wrong constant.
    pub fn constants(&self, raw: &RawBench, wrong: &mut Collector) -> Option<JointConstants> {
        let given = raw.constants.as_ref();
        let range = given.and_then(|given| given.link_range_rad.as_ref());
        let range = range.map(|range| positive(range, "constants.link_range_rad", wrong));
        let load_gear = given.and_then(|given| given.load_gear_ratio.as_ref());
        let load_gear = load_gear.map(|ratio| positive(ratio, "constants.load_gear_ratio", wrong));
        let mut take = |name: &str, of: fn(&RawConstants) -> Option<&Spanned<f64>>, sheet: Option<f64>| {
            either(given.and_then(of), sheet, &format!("constants.{name}"), raw, wrong)
        };
        let torque_constant = self.constant(|c| c.torque_constant_nm_per_a);
        let torque_constant =
            take("torque_constant_nm_per_a", |r| r.torque_constant_nm_per_a.as_ref(), torque_constant);
        let ratio = take("gear_ratio", |r| r.gear_ratio.as_ref(), self.constant(|c| c.gear_ratio));
        let inertia = self.constant(|c| c.rotor_inertia_kg_m2);
        let inertia = take("rotor_inertia_kg_m2", |r| r.rotor_inertia_kg_m2.as_ref(), inertia);
        let compliance = self.constant(|c| c.brake_compliance_v).or(self.without_brake);
        let compliance = take("brake_compliance_v", |r| r.brake_compliance_v.as_ref(), compliance);
        let current = self.constant(|c| c.brake_rated_current_a).or(self.without_brake);
        let current = take("brake_rated_current_a", |r| r.brake_rated_current_a.as_ref(), current);
        let torque = self.constant(|c| c.brake_rated_torque_nm).or(self.without_brake);
        let torque = take("brake_rated_torque_nm", |r| r.brake_rated_torque_nm.as_ref(), torque);
        Some(JointConstants {
            torque_constant_nm_per_a: torque_constant?,
            gear_ratio: ratio?,
            rotor_inertia_kg_m2: inertia?,
            brake_compliance_v: compliance?,
            brake_rated_current_a: current?,
            brake_rated_torque_nm: torque?,
            link_range_rad: flip(range)?.or(self.known.as_ref().and_then(|(_, constants)| constants.link_range_rad)),
            load_gear_ratio: flip(load_gear)?
                .or(self.known.as_ref().and_then(|(_, constants)| constants.load_gear_ratio)),
        })
    }
}

/// The given value, or the value of the data sheet.
fn either(
    given: Option<&Spanned<f64>>,
    sheet: Option<f64>,
    name: &str,
    raw: &RawBench,
    wrong: &mut Collector,
) -> Option<f64> {
    match given {
        Some(given) => positive(given, name, wrong),
        None if sheet.is_some() => sheet,
        None => {
            let cure = "required for a bench with real instruments";
            wrong.add(raw.name.span(), format!("{name} is missing: {cure}"));
            None
        }
    }
}

/// Refuses a limit above the range or the rating of an instrument: it would not protect.
pub fn check_reach(raw: &RawBench, limits: &Limits, constants: &JointConstants, wrong: &mut Collector) {
    let Some(given) = &raw.limits else { return };
    if let (Some(place), Some(sensor)) = (&given.link_torque_nm, &raw.torque_sensor) {
        let nominal_nm = *sensor.nominal_nm.get_ref();
        if limits.link_torque_nm > nominal_nm {
            let message = format!(
                "limits.link_torque_nm = {}: the range of the torque sensor is {nominal_nm} Nm",
                limits.link_torque_nm
            );
            wrong.add(place.span(), format!("{message}; reduce the limit to this value"));
        }
    }
    if let (Some(place), Some(_)) = (&given.brake_current_a, &raw.brake)
        && limits.brake_current_a > ABOVE_RATED * constants.brake_rated_current_a
    {
        let rated_a = constants.brake_rated_current_a;
        let message =
            format!("limits.brake_current_a = {}: the brake is rated for {rated_a} A", limits.brake_current_a);
        wrong.add(place.span(), format!("{message}; reduce the limit to at most 110 % of the rating"));
    }
}

/// The monitor of the torsion needs the torque and both encoders of the joint.
pub fn check_torsion(
    given: &Spanned<RawTorsion>,
    source: Option<&Source>,
    wrong: &mut Collector,
) -> Option<TorsionLimit> {
    if source.is_some_and(|source| !source.measures_torsion()) {
        let what =
            "torsion: this bench has no torque sensor, or no link encoder (link_encoder = true): remove the table";
        wrong.add(given.span(), what);
        return None;
    }
    let RawTorsion { compliance_rad_per_nm, tolerance_rad } = given.get_ref();
    let compliance = positive(compliance_rad_per_nm, "torsion.compliance_rad_per_nm", wrong);
    let tolerance = positive(tolerance_rad, "torsion.tolerance_rad", wrong);
    Some(TorsionLimit { compliance_rad_per_nm: compliance?, tolerance_rad: tolerance? })
}
