//! What a bench could measure next, as the model sees it: plans that its limits allow, as settled stretches.

use crate::catalogue::procedure;
use crate::plan::{BenchFacts, Phase, Plan};
use jointbench_instrument::bench::JointConstants;
use jointbench_instrument::{Kind, Limits, Motion, RunTable};
use jointbench_model::{Choice, Stretch};
use serde_json::{Map, Value, json};

/// Room to the limits.
const SHARE_OF_LIMIT: f64 = 0.95;
/// Shares of the brake's rated current. Uneven, so that no two runs at hand are likely to have the same.
const LOADS: [f64; 4] = [0.0, 0.3, 0.5, 0.8];
/// Link side: where the Stribeck part of friction is looked for, and where it is over.
const SLOW_RAD_S: [f64; 2] = [0.008, 0.07];
const FASTEST_RATIO: f64 = 8.0;
const ACCELERATION_RAD_S2: f64 = 400.0;
/// A stroke holds its speed for so long at least.
const HELD_S: f64 = 0.6;

/// Runs that could be made next, the ordinary one first. `run`: the one at hand, which gives the sample rate; `parameters`:
/// what it was made with, where it came from a procedure.
pub fn menu(bench: &BenchFacts, run: &RunTable, parameters: &Map<String, Value>) -> Vec<Choice> {
    let ordinary = match run.kind() {
        // No procedure here moves an axis that slides: where that could be done, the ordinary run again would help.
        Kind::Friction if run.meta().motion == Motion::Linear => {
            let parameters = Map::from_iter([("repeats".to_owned(), json!(3))]);
            let (procedure, duration_s) = ("friction".to_owned(), f64::INFINITY);
            return vec![Choice { procedure, parameters, duration_s, stretches: Vec::new() }];
        }
        Kind::Friction => None,
        Kind::Encoder => Some(("encoder_linearity", json!({"repeats": 3}))),
        Kind::Stiffness => Some(("stiffness", json!({"repeats": 3}))),
        // It has no repeats of its own: it is looked at together with the run at hand.
        Kind::Brake => Some(("brake_hysteresis", json!({}))),
    };
    if let Some((id, parameters)) = ordinary {
        return repeated(id, parameters, bench).into_iter().collect();
    }
    let rate_hz = run.rate_hz().round();
    let mut menu = Vec::new();
    let mut offer = |id: &str, parameters: Value| {
        let Some(parameters) = parameters.as_object() else { return };
        if let Some(Ok(plan)) = procedure(id).map(|p| p.plan(parameters, bench))
            && plan.preview(bench).is_allowed()
        {
            menu.push(choice(&plan, parameters, bench));
        }
    };
    let mut ordinary = parameters.clone();
    ordinary.retain(|name, _| procedure("friction").is_some_and(|p| p.schema().iter().any(|s| s.name == name)));
    ordinary.insert("sample_rate_hz".into(), json!(rate_hz));
    // Another order than last time, or what changed with time then would do so again.
    let seed = ordinary.get("order_seed").and_then(Value::as_f64).unwrap_or(1.0) + 1.0;
    ordinary.insert("order_seed".into(), json!(seed));
    ordinary.entry("repeats").or_insert(json!(2));
    if !bench.has_brake || !bench.has_torque_sensor {
        ordinary.insert("load_levels".into(), json!(1));
    }
    offer("friction", Value::Object(ordinary));

    let gear = bench.constants.gear_ratio;
    let room_rad = bench.constants.link_range_rad.unwrap_or(0.6).min(0.6);
    let top_rad_s = SHARE_OF_LIMIT * bench.limits.motor_velocity_rad_s.min(fastest_rad_s(room_rad * gear));
    let slow = SLOW_RAD_S.map(|v| (v * gear).min(top_rad_s));
    let ranges = [
        (slow[0], slow[1], 5.0),
        (top_rad_s / FASTEST_RATIO / 2.0, top_rad_s / 2.0, 2.0),
        (top_rad_s / FASTEST_RATIO, top_rad_s, 2.0),
    ];
    for repeats in [2, 4] {
        for load in LOADS.iter().filter(|load| **load == 0.0 || bench.has_brake && bench.has_torque_sensor) {
            // Under load the wind-up of joint and brake outlasts a slow stroke.
            for (low_rad_s, high_rad_s, dwell_s) in ranges.into_iter().skip(usize::from(*load > 0.0)) {
                let acceleration_rad_s2 = if *load > 0.0 {
                    ACCELERATION_RAD_S2
                } else {
                    rounded((high_rad_s / 0.2).min(ACCELERATION_RAD_S2))
                };
                offer(
                    "strokes",
                    json!({
                        "low_speed_rad_s": rounded(low_rad_s), "top_speed_rad_s": rounded(high_rad_s), "speeds": 4, "load": load,
                        "repeats": repeats, "dwell_s": dwell_s, "travel_rad": rounded(room_rad),
                        "acceleration_rad_s2": acceleration_rad_s2, "sample_rate_hz": rate_hz,
                        "order_seed": seed,
                    }),
                );
            }
        }
    }
    menu
}

/// A run for its repeats, with its duration where the bench may make it. Benches that only a run has shown are not known
/// well enough to plan for.
fn repeated(id: &str, parameters: Value, bench: &BenchFacts) -> Option<Choice> {
    let parameters = parameters.as_object()?.clone();
    let plan = procedure(id)?.plan(&parameters, bench).ok().filter(|plan| plan.preview(bench).is_allowed());
    let duration_s = plan.map_or(f64::INFINITY, |plan| plan.duration_s());
    Some(Choice { procedure: id.into(), parameters, duration_s, stretches: Vec::new() })
}

/// The highest speed that a stroke of this length reaches, holds and leaves: `v·t + v²/a = way`.
fn fastest_rad_s(way_rad: f64) -> f64 {
    let half = 0.5 * ACCELERATION_RAD_S2 * HELD_S;
    (half * half + ACCELERATION_RAD_S2 * way_rad).sqrt() - half
}

/// Two digits, downwards: what a person would type, and never beyond a limit.
fn rounded(value: f64) -> f64 {
    let unit = 10f64.powf(value.log10().floor() - 1.0);
    let whole = (value / unit * (1.0 + 1e-9)).floor();
    // Dividing by a whole power gives 0.12 where multiplying by 0.01 gives 0.12000000000000001.
    if unit < 1.0 { whole / unit.recip().round() } else { whole * unit }
}

impl BenchFacts {
    /// A bench that may do what a run has shown that it can, where nothing else is known of it.
    pub fn shown_by(run: &RunTable) -> Self {
        let largest = |name: &str| run.column(name).map(|c| c.iter().fold(0.0f64, |m, v| m.max(v.abs())));
        let meta = run.meta();
        let brake_a = largest("brake_current_a").unwrap_or(0.0);
        let link_nm = largest("link_torque_nm").unwrap_or(0.0);
        let gear_ratio = meta.gear_ratio.unwrap_or(1.0);
        let range_rad = run.column("motor_position_rad").map(|q| {
            let (low, high) = q.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
            (high - low) / gear_ratio
        });
        let rated_a = meta.rated_current_a.unwrap_or(brake_a).max(f64::MIN_POSITIVE);
        Self {
            name: "shown by the run".into(),
            simulated: false,
            limits: Limits {
                motor_velocity_rad_s: speed_rad_s(run),
                brake_current_a: brake_a,
                motor_current_a: f64::INFINITY,
                link_torque_nm: f64::INFINITY,
                temperature_c: f64::INFINITY,
                brake_power_w: f64::INFINITY,
            },
            constants: JointConstants {
                torque_constant_nm_per_a: meta.torque_constant_nm_per_a.unwrap_or(1.0),
                gear_ratio,
                rotor_inertia_kg_m2: meta.rotor_inertia_kg_m2.unwrap_or(0.0),
                brake_compliance_v: 0.0,
                brake_rated_current_a: rated_a,
                brake_rated_torque_nm: if brake_a > 0.0 { link_nm * rated_a / brake_a } else { 0.0 },
                link_range_rad: range_rad,
            },
            has_torque_sensor: link_nm > 0.0,
            has_two_ranges: false,
            has_brake: brake_a > 0.0,
            encoder_counts: None,
            has_stage: false,
            amperes_per_volt: None,
            brake_model: None,
            feeds_forward: true,
        }
    }
}

/// The highest speed that a run held for a tenth of a second.
fn speed_rad_s(run: &RunTable) -> f64 {
    let (time_s, position) =
        (run.column("time_s").unwrap_or_default(), run.column("motor_position_rad").unwrap_or_default());
    let apart = time_s.iter().take_while(|t| **t - time_s[0] < 0.1).count().max(1);
    let runs = time_s.iter().zip(position).zip(time_s.iter().zip(position).skip(apart));
    runs.filter(|((t0, _), (t1, _))| *t1 - *t0 < 0.2)
        .map(|((t0, q0), (t1, q1))| ((q1 - q0) / (t1 - t0)).abs())
        .fold(0.0, f64::max)
}

/// The plan as the model sees it. A warm-up may be cut short: nobody counts on it.
fn choice(plan: &Plan, parameters: &Map<String, Value>, bench: &BenchFacts) -> Choice {
    let constants = &bench.constants;
    let (mut start_s, mut at_rad) = (0.0, 0.0);
    let mut stretches = Vec::new();
    for step in &plan.steps {
        let way = step.velocity.integral();
        for (pair, from_rad) in step.velocity.knots().windows(2).zip(&way) {
            let [(from_s, velocity_rad_s), (to_s, end_rad_s)] = [pair[0], pair[1]];
            let current_a = step.brake.at(from_s);
            let held = velocity_rad_s == end_rad_s && velocity_rad_s != 0.0 && current_a == step.brake.at(to_s);
            if held && to_s > from_s && step.phase == Phase::Measure {
                let brake_nm = constants.brake_rated_torque_nm * current_a / constants.brake_rated_current_a;
                stretches.push(Stretch {
                    start_s: start_s + from_s,
                    duration_s: to_s - from_s,
                    velocity_rad_s,
                    from_rad: at_rad + from_rad,
                    load_nm: brake_nm * velocity_rad_s.signum(),
                });
            }
        }
        start_s += step.duration_s();
        at_rad += way.last().unwrap_or(&0.0);
    }
    Choice {
        procedure: plan.procedure.into(),
        parameters: parameters.clone(),
        duration_s: plan.duration_s(),
        stretches,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameter::Values;
    use jointbench_instrument::{Channel, Meta, Trace};

    #[test]
    fn what_is_offered_for_any_kind_can_be_started() {
        for kind in Kind::ALL {
            let columns = kind.required_columns();
            let mut trace = Trace::new(columns.iter().copied().map(Channel::new).collect());
            for row in 0..100 {
                trace.push_row(&vec![0.01 * f64::from(row); columns.len()]);
            }
            let run = RunTable::new(Meta { kind: Some(kind), ..Meta::default() }, trace).unwrap();
            let offered = menu(&BenchFacts::shown_by(&run), &run, &Map::new());
            assert!(kind == Kind::Friction || offered.len() == 1, "{kind}");
            for choice in offered {
                let known = procedure(&choice.procedure).unwrap_or_else(|| panic!("{kind}: {}", choice.procedure));
                assert_eq!(known.kind(), kind);
                Values::parse(known.schema(), &choice.parameters).unwrap();
            }
        }
    }
}
