//! Friction compensation by feedforward of motor current, evaluated on a reference trajectory (thesis, sections 4.2.2
//! to 4.2.6, table 4.7).
//!
//! The same oscillation is followed with each compensation method. The feedforward is planned from the friction in
//! the parameters and never exceeds it, because over-compensation makes the controller active.

mod identify;

use super::legs::{Legs, sample_rate};
use super::{Findable, Procedure};
use crate::bench_facts::BenchFacts;
use crate::findings::verdict;
use crate::identification::{FollowUp, Identification};
use crate::parameter::{Parameter, Values};
use crate::plan::{Drive, Feedforward, Plan, PlanFault};
use crate::profile::Profile;
use jointbench_instrument::{Kind, RunTable};
use serde_json::{Map, Value};
use std::f64::consts::TAU;

pub(super) struct Compensation;

const SCHEMA: &[Parameter] = &[
    Parameter::number("tau_c_nm", "Coulomb friction (motor)", "Nm", 0.030, [0.0, 100.0]),
    Parameter::number("c_v_nm_s", "Viscous friction (motor)", "Nm·s/rad", 1.512e-4, [0.0, 10.0]),
    Parameter::number("tau_h_nm", "Friction at zero speed (motor)", "Nm", 0.039, [0.0, 100.0]),
    Parameter::number("stribeck_speed_rad_s", "Stribeck velocity (link)", "rad/s", 0.06, [0.001, 10.0]),
    Parameter::number("stribeck_exponent", "Stribeck exponent", "", 0.8, [0.1, 4.0]),
    Parameter::number("share", "Fraction of the friction that is compensated", "", 0.95, [0.1, 1.0]),
    Parameter::number("amplitude_rad_s", "Amplitude of the reference (link)", "rad/s", 0.15, [0.01, 20.0]),
    Parameter::number("period_s", "Period of the reference", "s", 6.0, [0.5, 120.0]),
    Parameter::count("periods", "Periods with each method", 3, [2, 100]),
    Parameter::number("acceleration_rad_s2", "Acceleration between methods (motor)", "rad/s²", 400.0, [10.0, 5000.0]),
    sample_rate(250.0),
];

/// Around zero velocity the jump of Coulomb friction is omitted or linearised (thesis, section 4.2.3; link side).
const RAMP_RAD_S: f64 = 0.05;
/// The full model includes that region: its slope is limited only by the uncertainty of the velocity set-point.
const STEEP_RAD_S: f64 = 0.002;
/// Corner frequency of the observer.
const CORNER_HZ: f64 = 10.0;
/// Points of a planned current in one period.
const POINTS: u32 = 1000;

/// The compensation methods, in the order of table 4.7; the column `repeat` numbers them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Method {
    None,
    ZeroArea,
    Interpolated,
    CoulombViscous,
    Full,
    Observer,
}

impl Method {
    const ALL: [Method; 6] =
        [Method::None, Method::ZeroArea, Method::Interpolated, Method::CoulombViscous, Method::Full, Method::Observer];

    fn words(self) -> [&'static str; 2] {
        match self {
            Method::None => ["none", "no compensation"],
            Method::ZeroArea => ["zero_area", "Coulomb with dead band"],
            Method::Interpolated => ["interpolated", "Coulomb, interpolated"],
            Method::CoulombViscous => ["coulomb_viscous", "Coulomb and viscous"],
            Method::Full => ["full", "full model"],
            Method::Observer => ["observer", "observer"],
        }
    }
}

/// Friction from the parameters, over the link velocity; motor torque.
struct FrictionParameters {
    coulomb_nm: f64,
    viscous_nm_s: f64,
    rise_nm: f64,
    stribeck_rad_s: f64,
    exponent: f64,
    gear_ratio: f64,
}

impl FrictionParameters {
    fn new(values: &Values, gear_ratio: f64) -> Self {
        let coulomb_nm = values.number("tau_c_nm");
        Self {
            coulomb_nm,
            viscous_nm_s: values.number("c_v_nm_s"),
            rise_nm: (values.number("tau_h_nm") - coulomb_nm).max(0.0),
            stribeck_rad_s: values.number("stribeck_speed_rad_s"),
            exponent: values.number("stribeck_exponent"),
            gear_ratio,
        }
    }

    fn friction_nm(&self, link_rad_s: f64) -> f64 {
        let fading = (-(link_rad_s.abs() / self.stribeck_rad_s).powf(self.exponent)).exp();
        let speed_nm = self.viscous_nm_s * self.gear_ratio * link_rad_s.abs();
        (self.coulomb_nm + self.rise_nm * fading + speed_nm).copysign(link_rad_s)
    }

    /// Planned feedforward before scaling. `None`: the method has no planned feedforward.
    fn fed_nm(&self, method: Method, link_rad_s: f64) -> Option<f64> {
        let line = |over: f64| (link_rad_s / over).clamp(-1.0, 1.0);
        let viscous_nm = self.viscous_nm_s * self.gear_ratio * link_rad_s;
        match method {
            Method::None | Method::Observer => None,
            Method::ZeroArea if link_rad_s.abs() < RAMP_RAD_S => Some(0.0),
            Method::ZeroArea => Some(self.coulomb_nm.copysign(link_rad_s)),
            Method::Interpolated => Some(self.coulomb_nm * line(RAMP_RAD_S)),
            Method::CoulombViscous => Some(self.coulomb_nm * line(RAMP_RAD_S) + viscous_nm),
            Method::Full => Some(self.friction_nm(link_rad_s).abs() * line(STEEP_RAD_S)),
        }
    }
}

impl Procedure for Compensation {
    fn id(&self) -> &'static str {
        "compensation"
    }

    fn title(&self) -> &'static str {
        "Friction compensation"
    }

    fn summary(&self) -> &'static str {
        "Follows a reference with six methods of friction compensation, from none to the full model and an observer. \
         Compares their tracking errors."
    }

    fn kind(&self) -> Kind {
        Kind::Friction
    }

    fn is_modelled(&self) -> bool {
        false
    }

    fn schema(&self) -> &'static [Parameter] {
        SCHEMA
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        if values.number("tau_h_nm") < values.number("tau_c_nm") {
            return Err(PlanFault::Contradiction {
                what: "tau_h_nm must not be below tau_c_nm".into(),
                cure: "swap the two values, or make them equal",
            });
        }
        let constants = &bench.constants;
        let rate_hz = values.number("sample_rate_hz");
        let friction = FrictionParameters::new(values, constants.gear_ratio);
        let period_s = values.number("period_s");
        let points = POINTS * values.count("periods");
        let step_s = period_s / f64::from(POINTS);
        let link_rad_s = |i: u32| values.number("amplitude_rad_s") * (TAU * f64::from(i) / f64::from(POINTS)).sin();
        let profile = |value: &dyn Fn(f64) -> f64| {
            (1..=points).fold(Profile::from(0.0), |profile, i| profile.to(value(link_rad_s(i)), step_s))
        };
        // The last point of a sine is zero except for rounding.
        let velocity = profile(&|v| constants.gear_ratio * v).to(0.0, 0.0);
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        for method in Method::ALL {
            legs.repeat = method as u32;
            legs.push(method.words()[1].into(), velocity.clone(), Profile::constant(0.0));
            let share = values.number("share");
            let fed_a = |v: f64| share * friction.fed_nm(method, v).unwrap_or(0.0) / constants.torque_constant_nm_per_a;
            match method {
                Method::None => {}
                Method::Observer => {
                    let ramp_rad_s = RAMP_RAD_S * constants.gear_ratio;
                    legs.drive_of_last(Drive::Fed(Feedforward::Observed { share, corner_hz: CORNER_HZ, ramp_rad_s }));
                }
                _ => legs.drive_of_last(Drive::Fed(Feedforward::Planned(profile(&fed_a)))),
            }
            over_compensates(&friction, method, share, values.number("amplitude_rad_s"))?;
        }
        Ok(legs.friction_plan(self, values, bench, rate_hz))
    }

    fn finds(&self) -> Vec<Findable> {
        let of_method = |method: Method| {
            let [suffix, _] = method.words();
            identify::FIGURES.map(|[name, _, _, unit]| Findable { name: format!("{name}_{suffix}"), unit })
        };
        Method::ALL.into_iter().flat_map(of_method).collect()
    }

    fn identify(&self, values: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify::identify(values.number("period_s"), run))
    }
}

/// Compensation with the friction identified by a run. Without a significant Stribeck rise there is no compensation
/// for it. If the directions differ, the smaller friction is used, because the feedforward may exceed neither.
pub(super) fn of_friction(found: &Identification) -> Option<FollowUp> {
    let differ = |name: &str| {
        let ends = found.quantity(&format!("{name}_difference")).and_then(|difference| difference.ci95);
        ends.is_some_and(|[low, high]| low > 0.0 || high < 0.0)
    };
    let differ = differ("tau_c") || differ("c_v");
    let value = |name: &str| {
        let both = found.quantity(name)?.value;
        let way = |way: &str| Some(found.quantity(&format!("{name}_{way}"))?.value.abs());
        let ways = ["positive", "negative"].map(way);
        let least = ways.into_iter().flatten().fold(both, f64::min);
        // Velocity and exponent are nonlinear parameters, not magnitudes.
        let is_size = ["tau_c", "c_v", "tau_h"].contains(&name);
        Some(four_digits(if differ && is_size { least } else { both }))
    };
    let coulomb_nm = value("tau_c")?;
    let given = [
        ("tau_c_nm", Some(coulomb_nm)),
        ("c_v_nm_s", Some(value("c_v")?)),
        ("tau_h_nm", Some(value("tau_h").map_or(coulomb_nm, |rest_nm| rest_nm.max(coulomb_nm)))),
        ("stribeck_speed_rad_s", value("omega_s")),
        ("stribeck_exponent", value("delta_s")),
    ];
    let parameters: Map<String, Value> =
        given.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?.into()))).collect();
    Values::parse(SCHEMA, &parameters).ok()?;
    let why = "compare the compensation methods with these values";
    Some(FollowUp { procedure: Compensation.id(), parameters, why })
}

/// Rounds to a number of digits that a person would type.
fn four_digits(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Rejects a feedforward that exceeds the stated friction at any speed of the reference.
fn over_compensates(
    friction: &FrictionParameters,
    method: Method,
    share: f64,
    top_rad_s: f64,
) -> Result<(), PlanFault> {
    let over = (1..=POINTS).map(|i| top_rad_s * f64::from(i) / f64::from(POINTS)).find(|v| {
        friction.fed_nm(method, *v).is_some_and(|fed_nm| share * fed_nm > friction.friction_nm(*v) * (1.0 + 1e-9))
    });
    match over {
        None => Ok(()),
        Some(v) => Err(PlanFault::Contradiction {
            what: format!("{} would over-compensate at {v:.3} rad/s (link)", method.words()[1]),
            cure: "reduce share",
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::super::legs::testing::joint_a;
    use super::*;
    use crate::findings::quantity;
    use crate::identification::Verdict;
    use serde_json::json;

    #[test]
    fn every_way_follows_the_same_reference_and_none_exceeds_friction() {
        let plan = Compensation.plan(json!({}).as_object().unwrap(), &joint_a()).unwrap();
        assert!(plan.preview(&joint_a()).is_allowed(), "{:?}", plan.preview(&joint_a()).checks);
        assert_eq!(plan.steps.len(), Method::ALL.len());
        assert!(plan.steps.iter().all(|step| step.velocity == plan.steps[0].velocity));
        // At most the stated friction at the top speed of the reference.
        let most_a = (0.039 + 1.512e-4 * 0.15 * 177.8) / 0.0406;
        assert!(plan.top_motor_current_a() < most_a, "{} A", plan.top_motor_current_a());
        assert!(plan.top_motor_current_a() > 0.9 * 0.95 * (0.030 + 1.512e-4 * 0.15 * 177.8) / 0.0406);
    }

    #[test]
    fn a_drive_without_feedforward_is_reported_before_anything_moves() {
        let bench = BenchFacts { feeds_forward: false, ..joint_a() };
        let preview = Compensation.plan(json!({}).as_object().unwrap(), &bench).unwrap().preview(&bench);
        let refused: Vec<_> = preview.checks.iter().filter(|check| !check.ok).collect();
        assert_eq!(refused.len(), 1, "{refused:?}");
        assert!(refused[0].detail.contains("does not support motor current feed-forward") && refused[0].cure.is_some());
    }

    #[test]
    fn what_friction_found_is_handed_over() {
        let found = |values: &[(&str, f64)]| Identification {
            verdict: Verdict::Identified,
            summary: String::new(),
            quantities: values.iter().map(|(name, value)| quantity([name, "", "", ""], *value, None)).collect(),
            ..Identification::default()
        };
        let all = [("tau_c", 0.030_612_3), ("c_v", 1.5e-4), ("tau_h", 0.0391), ("omega_s", 0.06), ("delta_s", 0.8)];
        let next = of_friction(&found(&all)).unwrap();
        assert_eq!(next.parameters["tau_c_nm"], 0.030_61);
        assert!(Compensation.plan(&next.parameters, &joint_a()).is_ok());
        let flat = of_friction(&found(&all[..2])).unwrap();
        assert_eq!(flat.parameters["tau_h_nm"], flat.parameters["tau_c_nm"], "no rise was seen");
        assert_eq!(of_friction(&found(&all[1..])), None);
    }

    #[test]
    fn where_the_directions_differ_the_easier_one_is_compensated() {
        let sided = |low_nm: f64| {
            let given = [("tau_c", 0.0301, None), ("c_v", 1.5e-4, None), ("tau_c_positive", 0.0343, None)];
            let more = [("tau_c_negative", -0.0250, None), ("tau_c_difference", 0.0093, Some([low_nm, 0.012]))];
            let quantities =
                given.into_iter().chain(more).map(|(name, value, ci95)| quantity([name, "", "", ""], value, ci95));
            let (summary, quantities) = (String::new(), quantities.collect());
            Identification { verdict: Verdict::Identified, summary, quantities, ..Identification::default() }
        };
        let fed = |low_nm: f64| of_friction(&sided(low_nm)).unwrap().parameters["tau_c_nm"].as_f64().unwrap();
        assert_eq!((fed(0.006), fed(-0.001)), (0.0250, 0.0301));
    }

    #[test]
    fn friction_that_falls_towards_standstill_is_refused() {
        let fault = Compensation.plan(json!({"tau_h_nm": 0.02}).as_object().unwrap(), &joint_a()).unwrap_err();
        assert!(fault.to_string().contains("tau_h_nm must not be below tau_c_nm"), "{fault}");
    }
}
