//! Friction compensation by feedforward of motor current, evaluated on a reference trajectory.
//!
//! The same reference is followed with each compensation method. The feedforward is planned from the friction in the
//! parameters and never exceeds it, because over-compensation makes the controller active.

mod cause;
mod followed;
mod identify;
mod method;
mod reference;

use super::legs::{Legs, sample_rate};
use super::{Findable, Procedure, ProcedureInfo};
use crate::bench_facts::BenchFacts;
use crate::findings::verdict;
use crate::identification::{FollowUp, Identification, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{Drive, Plan, PlanFault};
use crate::profile::Profile;
use jointbench_instrument::{Kind, RunTable};
use method::{FrictionParameters, Method};
use reference::Reference;
use serde_json::{Map, Value};

pub(super) struct Compensation;

/// The parameter of the dynamic model; 0 omits this method.
pub(super) const STIFFNESS: &str = "presliding_stiffness_nm_rad";

static INFO: ProcedureInfo = ProcedureInfo {
    id: "compensation",
    title: "Friction compensation",
    summary: "Follows a reference with up to ten methods of friction compensation: none, static models, a load term, a \
              dynamic model and an observer. Compares their tracking errors.",
    kind: Kind::Friction,
    schema: &[
        Parameter::number("tau_c_nm", "Coulomb friction (motor)", "Nm", 0.030, [0.0, 100.0]),
        Parameter::number("c_v_nm_s", "Viscous friction (motor)", "Nm·s/rad", 1.512e-4, [0.0, 10.0]),
        Parameter::number("tau_h_nm", "Friction at zero speed (motor)", "Nm", 0.039, [0.0, 100.0]),
        Parameter::number("stribeck_speed_rad_s", "Stribeck velocity (link)", "rad/s", 0.06, [0.001, 10.0]),
        Parameter::number("stribeck_exponent", "Stribeck exponent", "", 0.8, [0.1, 4.0]),
        Parameter::number(
            STIFFNESS,
            "Presliding stiffness for the dynamic model (motor; 0: unknown)",
            "Nm/rad",
            0.0,
            [0.0, 1e6],
        ),
        Parameter::number("load_friction", "Friction per Nm of load (motor; 0: unknown)", "", 0.0, [0.0, 0.9]),
        Parameter::fraction("load", "Brake current during the reference, relative to rated", 0.0, [0.0, 1.0]),
        Parameter::fraction("share", "Fraction of the friction that is compensated", 0.95, [0.1, 1.0]),
        Parameter::number("amplitude_rad_s", "Amplitude of the reference (link)", "rad/s", 0.15, [0.01, 20.0]),
        Parameter::number("period_s", "Period of the reference", "s", 6.0, reference::PERIOD_S),
        Parameter::number("ramp_s", "Ramp of a trapezoidal reference (0: sinusoid)", "s", 0.0, [0.0, 30.0]),
        reference::FROM_FILE,
        Parameter::count("periods", "Periods with each method; the first is not evaluated", 2, [2, 100]),
        Parameter::count("rounds", "Rounds of all methods; their scatter gives the intervals", 3, [1, 20]),
        Parameter::number(
            "acceleration_rad_s2",
            "Acceleration between methods (motor)",
            "rad/s²",
            400.0,
            [10.0, 5000.0],
        ),
        sample_rate(250.0),
    ],
};

/// Brake current at which the load term is compared, fraction of rated.
const LOAD: f64 = 0.5;
/// Speeds at which the feedforward is compared with the friction.
const CHECKED: u32 = 1000;
/// Number in the column `repeat` of the steps between the methods.
const NO_METHOD: u32 = 99;

impl Procedure for Compensation {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn is_modelled(&self) -> bool {
        false
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
        let friction = FrictionParameters::new(values, constants);
        let reference = Reference::of(values)?;
        let (period, step_s) = (&reference.velocity_rad_s, reference.step_s);
        let (periods, share) = (values.count("periods"), values.number("share"));
        let setpoints = period.iter().cycle().take(period.len() * periods as usize);
        let velocity = setpoints.fold(Profile::from(0.0), |profile, v| profile.to(constants.gear_ratio * v, step_s));
        let top_rad_s = reference.top_rad_s();
        let load_a = self.load_a(values, bench)?;
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        legs.repeat = NO_METHOD;
        if load_a > 0.0 {
            legs.change(top_rad_s * constants.gear_ratio, 0.0, load_a);
        }
        let methods = Method::ALL.into_iter().filter(|method| method.is_planned(values));
        let methods = methods.map(|method| (method, friction.drive(method, share, period, step_s, periods)));
        let mut methods: Vec<(Method, Drive)> = methods.collect();
        for (method, _) in &methods {
            over_compensates(&friction, *method, share, top_rad_s)?;
        }
        let rounds = values.count("rounds");
        for round in 0..rounds {
            for (method, drive) in &methods {
                legs.repeat = method.repeat(round);
                let label = format!("{}, round {} of {rounds}", method.words()[1], round + 1);
                legs.push(label, velocity.clone(), Profile::constant(load_a));
                legs.drive_of_last(drive.clone());
            }
            // Reversed in the next round, so that a steady drift affects all methods alike.
            methods.reverse();
        }
        legs.repeat = NO_METHOD;
        if load_a > 0.0 {
            legs.unload(top_rad_s * constants.gear_ratio, load_a, bench);
        }
        Ok(legs.friction_plan(self, values, bench, rate_hz))
    }

    fn finds(&self) -> Vec<Findable> {
        let of_method = |method: Method| {
            let [suffix, _] = method.words();
            followed::FIGURES.map(|[name, _, _, unit]| Findable { name: format!("{name}_{suffix}"), unit })
        };
        Method::ALL.into_iter().flat_map(of_method).collect()
    }

    fn identify(&self, values: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify::identify(reference::period_s(values), run))
    }
}

impl Compensation {
    fn load_a(&self, values: &Values, bench: &BenchFacts) -> Result<f64, PlanFault> {
        if values.number("load") > 0.0 && !bench.has_brake {
            return Err(bench.missing("brake", "set load to 0"));
        }
        if values.number("load_friction") > 0.0 && !bench.has_torque_sensor {
            return Err(bench.missing("torque sensor", "set load_friction to 0"));
        }
        Ok(values.number("load") * bench.constants.brake_rated_current_a)
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
    Values::parse(INFO.schema, &parameters).ok()?;
    let why = "compare the compensation methods with these values";
    Some(FollowUp { procedure: Compensation.id().to_owned(), parameters, why: why.to_owned() })
}

/// Comparison of the dynamic model with the static ones, with the presliding stiffness that a run has identified.
pub(super) fn of_presliding(found: &Identification) -> Option<FollowUp> {
    let stiffness = found.quantity("sigma_0").filter(|_| found.verdict == Verdict::Identified)?;
    let parameters = Map::from_iter([(STIFFNESS.to_owned(), Value::from(four_digits(stiffness.value)))]);
    Values::parse(INFO.schema, &parameters).ok()?;
    let why = "compare the dynamic model with the static ones";
    Some(FollowUp { procedure: Compensation.id().to_owned(), parameters, why: why.to_owned() })
}

/// Comparison of the load term with the other methods, with the load-dependent friction that a run has identified.
pub(super) fn of_load(found: &Identification) -> Option<FollowUp> {
    let grows = found.quantity("mu").filter(|mu| mu.ci95.is_some_and(|[low, _]| low > 0.0))?;
    let mut next = of_friction(found)?;
    next.parameters.insert("load_friction".into(), four_digits(grows.value).into());
    next.parameters.insert("load".into(), LOAD.into());
    Values::parse(INFO.schema, &next.parameters).ok()?;
    Some(FollowUp { why: "compare the load term with the other methods, under load".to_owned(), ..next })
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
    let over = (1..=CHECKED).map(|i| top_rad_s * f64::from(i) / f64::from(CHECKED)).find(|v| {
        friction.static_nm(method, *v).is_some_and(|fed_nm| share * fed_nm > friction.friction_nm(*v) * (1.0 + 1e-9))
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
    use crate::plan::Feedforward;
    use serde_json::json;

    #[test]
    fn every_way_follows_the_same_reference_and_none_exceeds_friction() {
        let plan = Compensation.plan(json!({}).as_object().unwrap(), &joint_a()).unwrap();
        assert!(plan.preview(&joint_a()).is_allowed(), "{:?}", plan.preview(&joint_a()).checks);
        // Without their parameters the load term and the dynamic model are omitted.
        assert_eq!(plan.steps.len(), 3 * (Method::ALL.len() - 2));
        assert!(plan.steps.iter().all(|step| step.velocity == plan.steps[0].velocity));
        // At most the stated friction at the top speed of the reference.
        let most_a = (0.039 + 1.512e-4 * 0.15 * 177.8) / 0.0406;
        assert!(plan.top_motor_current_a() < most_a, "{} A", plan.top_motor_current_a());
        assert!(plan.top_motor_current_a() > 0.9 * 0.95 * (0.030 + 1.512e-4 * 0.15 * 177.8) / 0.0406);
    }

    #[test]
    fn a_reference_of_the_user_is_followed_in_every_period() {
        let own =
            json!({"periods": 3, "reference": [[0, 0], [1, 0.2], [2, 0.2], [3, 0], [4, -0.1], [8, -0.1], [9, 0]]});
        let plan = Compensation.plan(own.as_object().unwrap(), &joint_a()).unwrap();
        let (gear, velocity) = (joint_a().constants.gear_ratio, &plan.steps[0].velocity);
        assert!((velocity.duration_s() - 27.0).abs() < 1e-6);
        for (t_s, v) in [(0.5, 0.1), (1.5, 0.2), (6.0, -0.1), (9.0, 0.0), (9.5, 0.1), (24.0, -0.1)] {
            assert!((velocity.at(t_s) / gear - v).abs() < 1e-3, "{} rad/s at {t_s} s", velocity.at(t_s) / gear);
        }
        let refused = |points: Value| {
            Compensation.plan(json!({"reference": points}).as_object().unwrap(), &joint_a()).unwrap_err().to_string()
        };
        for (points, message) in [
            (json!([[0, 0], [0.2, 0.1], [0.4, 0]]), "reference takes 0.4 s, expected 0.5 to 120 s"),
            (json!([[0, 0], [1, 0.1], [2, -0.1]]), "reference has -0.1 rad/s at 2 s: begin and end it at rest"),
            (json!([[0, 0], [1, 0.1], [2, 0]]), "reference has one direction only"),
            (json!([[0, 0], [1, 30], [2, 0]]), "parameter reference: 30 at 1 s: expected -20 to 20 rad/s"),
        ] {
            let refused = refused(points);
            assert!(refused.contains(message), "{refused}");
        }
    }

    #[test]
    fn a_trapezoid_reaches_its_speed_in_its_ramp_and_ends_at_rest() {
        let given = json!({"ramp_s": 0.5, "period_s": 4.0, "amplitude_rad_s": 0.2});
        let plan = Compensation.plan(given.as_object().unwrap(), &joint_a()).unwrap();
        let velocity = &plan.steps[0].velocity;
        for (t_s, link_rad_s) in
            [(0.25, 0.1), (0.5, 0.2), (1.4, 0.2), (2.0, 0.0), (2.5, -0.2), (3.75, -0.1), (20.0, 0.0)]
        {
            assert!((velocity.at(t_s) - 177.8 * link_rad_s).abs() < 1e-9, "{} at {t_s} s", velocity.at(t_s));
        }
        let fault = Compensation.plan(json!({"ramp_s": 2.0}).as_object().unwrap(), &joint_a()).unwrap_err();
        assert!(fault.to_string().contains("above a quarter of period_s = 6"), "{fault}");
    }

    #[test]
    fn the_dynamic_model_follows_the_static_one_in_steady_motion_and_lags_it_after_a_reversal() {
        let values = |stiffness_nm_rad: f64| {
            let given = json!({STIFFNESS: stiffness_nm_rad, "ramp_s": 0.1, "period_s": 4.0, "share": 1.0});
            Values::parse(INFO.schema, given.as_object().unwrap()).unwrap()
        };
        let planned = |method: Method, stiffness_nm_rad: f64| {
            let values = values(stiffness_nm_rad);
            let friction = FrictionParameters::new(&values, &joint_a().constants);
            let period = Reference::of(&values).unwrap().velocity_rad_s;
            match friction.drive(method, 1.0, &period, 0.004, 2) {
                Drive::Fed(Feedforward::Planned(current_a)) => current_a,
                drive => panic!("{drive:?}"),
            }
        };
        let (dynamic, full) = (planned(Method::Dynamic, 14.0), planned(Method::Full, 0.0));
        for t_s in [1.0, 3.0, 5.0, 7.0] {
            assert!((dynamic.at(t_s) - full.at(t_s)).abs() < 1e-5, "{} and {}", dynamic.at(t_s), full.at(t_s));
        }
        // 4 ms after the reversal at 2 s the motor has turned by less than the bristles bend.
        assert!(full.at(2.004) < 0.0 && dynamic.at(2.004) > full.at(2.004), "{} {}", dynamic.at(2.004), full.at(2.004));
    }

    #[test]
    fn a_load_needs_a_brake_and_its_friction_a_torque_sensor() {
        let refused = |given: Value, bench: BenchFacts| {
            Compensation.plan(given.as_object().unwrap(), &bench).unwrap_err().to_string()
        };
        let no_brake = refused(json!({"load": 0.5}), BenchFacts { has_brake: false, ..joint_a() });
        assert!(no_brake.contains("no brake: set load to 0"), "{no_brake}");
        let blind = refused(json!({"load_friction": 0.1}), BenchFacts { has_torque_sensor: false, ..joint_a() });
        assert!(blind.contains("no torque sensor: set load_friction to 0"), "{blind}");
        let loaded = json!({"load": 0.5, "load_friction": 0.1, STIFFNESS: 14.0});
        let plan = Compensation.plan(loaded.as_object().unwrap(), &joint_a()).unwrap();
        assert_eq!(plan.steps.iter().filter(|step| step.repeat != NO_METHOD).count(), 3 * Method::ALL.len());
        assert_eq!((plan.top_brake_current_a(), plan.steps.last().unwrap().brake.end()), (0.3, 0.0));
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
