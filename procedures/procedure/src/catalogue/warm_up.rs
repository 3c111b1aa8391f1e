//! Warm-up of the joint until temperature and friction are steady, or the time limit is reached.

use super::legs::{ACCELERATION, Legs, sample_rate, turn_s, within_range_s};
use super::{Findable, Procedure, ProcedureInfo, findable};
use crate::bench_facts::BenchFacts;
use crate::findings::{Plateau, Unusable, curve, plateaus, quantity, scatter, settled, verdict};
use crate::identification::{Axis, Figure, Form, Identification, Quantity, Series, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{Phase, Plan, PlanFault};
use crate::steady::SteadyCriterion;
use crate::steady::{Drift, SteadyDetector};
use jointbench_instrument::{Kind, RunTable};

pub(super) struct WarmUp;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "warm_up",
    title: "Warm-up",
    summary: "Runs the joint without load until temperature and current are steady. Run it before measurements that \
              are compared.",
    kind: Kind::Friction,
    schema: &[
        Parameter::number("top_speed_rad_s", "Speed (motor)", "rad/s", 180.0, [1.0, 1000.0]),
        Parameter::number("longest_s", "Maximum duration", "s", 900.0, [20.0, 7200.0]),
        Parameter::number("steady_c_per_min", "Steady when temperature drift is below", "°C/min", 0.3, [0.01, 10.0]),
        Parameter::number(
            "steady_share_per_min",
            "Steady when relative current drift is below",
            "1/min",
            0.01,
            [1e-4, 1.0],
        ),
        ACCELERATION,
        sample_rate(250.0),
    ],
};

/// Steps of one cycle: fast and slow, out and back.
pub(super) const CYCLE_STEPS: usize = 4;
/// Speed of the slow pair of a cycle: two speeds separate viscous from Coulomb friction while both change with
/// temperature. It is well above the Stribeck velocity, because the Stribeck rise would count as Coulomb friction.
pub(super) const SLOW_SHARE: f64 = 0.5;

impl Procedure for WarmUp {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn is_modelled(&self) -> bool {
        false
    }

    fn can_resume(&self) -> Result<(), &'static str> {
        Err("a warm-up is one history")
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let rate_hz = values.number("sample_rate_hz");
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        work(&mut legs, values.number("top_speed_rad_s"), values.number("longest_s"), bench);
        Ok(Plan { steady: Some(rule(values)), ..legs.friction_plan(self, values, bench, rate_hz) })
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[("Nm", "torque"), ("1/min", "current_drift"), ("°C/min", "temperature_drift")])
    }

    fn identify(&self, values: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify(values, run))
    }
}

fn rule(values: &Values) -> SteadyCriterion {
    SteadyCriterion {
        cycle_steps: CYCLE_STEPS,
        temperature_c_per_min: values.number("steady_c_per_min"),
        current_share_per_min: values.number("steady_share_per_min"),
    }
}

/// Fast legs of the last three cycles, which are judged.
const JUDGED: usize = 6;

fn identify(values: &Values, run: &RunTable) -> Result<Identification, Unusable> {
    let points = plateaus(&settled(run)?);
    let top = points.iter().map(|p| p.velocity_rad_s.abs()).fold(0.0, f64::max);
    let fast: Vec<Plateau> = points.into_iter().filter(|p| p.velocity_rad_s.abs() > 0.9 * top).collect();
    let rule = rule(values);
    // The same rule ends a warm-up: one that ended by itself has just fallen below the bound.
    let watch = SteadyDetector::of(rule, run);
    let Some((watch, drift)) = watch.and_then(|watch| watch.drift().map(|drift| (watch, drift))) else {
        return Err(Unusable::InsufficientData(
            "The warm-up ended before three cycles were completed.",
            "Increase longest_s.",
        ));
    };
    let has_temperature = run.column("temperature_c").is_some();
    let found = Identification {
        quantities: quantities(&fast, &drift, has_temperature),
        figures: figures(&fast, &watch, &rule, has_temperature),
        ..Identification::default()
    };
    let judged = judged(&rule, &drift, has_temperature);
    let over: Vec<&str> = judged.iter().filter(|(is_steady, _)| !is_steady).map(|(_, text)| text.as_str()).collect();
    Ok(if over.is_empty() {
        let all: Vec<&str> = judged.iter().map(|(_, text)| text.as_str()).collect();
        let summary = format!("Steady state reached: {}.", all.join(", "));
        Identification { verdict: Verdict::Identified, summary, ..found }
    } else {
        let summary = format!("Steady state not reached: {}.", over.join("; "));
        let advice = Some("Repeat the warm-up while the joint is warm, or increase longest_s.".to_owned());
        Identification { verdict: Verdict::Inconclusive, summary, advice, ..found }
    })
}

/// Whether current and temperature are steady, each drift with its limit in words.
fn judged(rule: &SteadyCriterion, drift: &Drift, has_temperature: bool) -> Vec<(bool, String)> {
    let current = format!(
        "current drift {:.2} %/min (limit {:.2} %/min, steady_share_per_min)",
        100.0 * drift.current_share_per_min,
        100.0 * rule.current_share_per_min
    );
    let mut judged = vec![(drift.is_current_steady(rule), current)];
    if has_temperature {
        let temperature = format!(
            "temperature drift {:.2} K/min (limit {} K/min, steady_c_per_min)",
            drift.temperature_c_per_min, rule.temperature_c_per_min
        );
        judged.push((drift.is_temperature_steady(rule), temperature));
    }
    judged
}

fn quantities(fast: &[Plateau], drift: &Drift, has_temperature: bool) -> Vec<Quantity> {
    let end = &fast[fast.len().saturating_sub(JUDGED)..];
    let last_nm = end.iter().map(|p| p.target.abs()).sum::<f64>() / end.len() as f64;
    let mut quantities = vec![
        quantity(["torque", "τ_m", "Motor torque at the end of the run, fast legs", "Nm"], last_nm, None),
        quantity(["current_drift", "i̇/i", "Drift of the motor current", "1/min"], drift.current_share_per_min, None),
    ];
    if has_temperature {
        let words = ["temperature_drift", "Ṫ", "Drift of the temperature", "°C/min"];
        quantities.push(quantity(words, drift.temperature_c_per_min, None));
    }
    quantities
}

fn figures(fast: &[Plateau], watch: &SteadyDetector, rule: &SteadyCriterion, has_temperature: bool) -> Vec<Figure> {
    let torque = |p: &Plateau| (p.time_s / 60.0, p.target.abs());
    let mut figures = vec![
        over_time("torque", "Motor torque of the fast legs", "motor torque", "Nm", fast, torque),
        until_steady(
            ["current_drift_over_time", "Drift of the motor current", "drift of the current", "1/min"],
            watch,
            rule.current_share_per_min,
            |drift| drift.current_share_per_min,
        ),
    ];
    if has_temperature {
        let temperature = |p: &Plateau| (p.time_s / 60.0, p.temperature_c);
        figures.push(over_time("temperature", "Temperature", "temperature", "°C", fast, temperature));
        figures.push(until_steady(
            ["temperature_drift_over_time", "Drift of the temperature", "drift of the temperature", "°C/min"],
            watch,
            rule.temperature_c_per_min,
            |drift| drift.temperature_c_per_min,
        ));
    }
    figures
}

fn over_time(
    name: &str,
    title: &str,
    label: &str,
    unit: &str,
    points: &[Plateau],
    of: fn(&Plateau) -> (f64, f64),
) -> Figure {
    over_minutes([name, title, label, unit], vec![scatter("fast legs", points.iter().map(of))])
}

/// `words`: name, title, label and unit.
fn over_minutes([name, title, label, unit]: [&str; 4], series: Vec<Series>) -> Figure {
    Figure {
        name: name.into(),
        title: title.into(),
        form: Form::Cartesian,
        x: Axis::of("time", "min"),
        y: Axis::of(label, unit),
        series,
    }
}

/// Drift at the end of each cycle, and the bounds within which the joint is warm. `words`: name, title, label and
/// unit.
fn until_steady(words: [&str; 4], watch: &SteadyDetector, bound: f64, of: fn(&Drift) -> f64) -> Figure {
    let points: Vec<(f64, f64)> = watch.drifts().map(|(time_s, drift)| (time_s / 60.0, of(&drift))).collect();
    let ends = [points.first().map_or(0.0, |p| p.0), points.last().map_or(1.0, |p| p.0)];
    let series = vec![
        scatter("over three cycles", points),
        curve("warm within", ends, 1, |_| bound),
        curve("warm within", ends, 1, |_| -bound),
    ];
    over_minutes(words, series)
}

/// Whole cycles of warm-up steps of at most `longest_s`, but at least one.
pub(super) fn work(legs: &mut Legs, top_speed_rad_s: f64, longest_s: f64, bench: &BenchFacts) {
    legs.phase = Phase::WarmUp;
    let mut cycle_s = 0.0;
    while legs.steps.is_empty() || legs.steps.len() as f64 / CYCLE_STEPS as f64 * cycle_s + cycle_s <= longest_s {
        let first = legs.steps.len();
        for (speed_rad_s, dwell_s) in
            [(top_speed_rad_s, turn_s(1.0, top_speed_rad_s, bench, 2.0)), (SLOW_SHARE * top_speed_rad_s, 2.0)]
        {
            let dwell_s = within_range_s(dwell_s, speed_rad_s, legs.acceleration_rad_s2, bench);
            legs.leg(speed_rad_s, dwell_s, 0.0);
            legs.leg(-speed_rad_s, dwell_s, 0.0);
        }
        cycle_s = legs.steps[first..].iter().map(crate::plan::Step::duration_s).sum();
    }
    legs.phase = Phase::Measure;
}

#[cfg(test)]
mod tests {
    use super::super::legs::testing::{joint_a, joint_b};
    use super::*;
    use serde_json::{Map, json};

    #[test]
    fn a_link_of_half_a_turn_is_warmed_within_it() {
        let mut facts = joint_a();
        facts.constants.link_range_rad = Some(3.0);
        let plan = WarmUp.plan(&Map::new(), &facts).unwrap();
        assert!(plan.preview(&facts).is_allowed(), "{:?}", plan.preview(&facts).checks);
    }

    #[test]
    fn it_is_bounded_and_returns_to_where_it_began() {
        for facts in [joint_a(), joint_b()] {
            let given = json!({"longest_s": 100.0});
            let plan = WarmUp.plan(given.as_object().unwrap(), &facts).unwrap();
            assert!((60.0..=100.0).contains(&plan.duration_s()), "{} s", plan.duration_s());
            let (lowest, highest) = plan.travel_rad();
            assert!(lowest > -1e-6 && highest / facts.constants.gear_ratio < 2.0 * std::f64::consts::TAU);
            assert!(plan.preview(&facts).is_allowed());
            assert_eq!(plan.steps.len() % CYCLE_STEPS, 0);
        }
    }
}
