//! One demanded load torque at every speed: the brake current is readjusted at each of them.
//!
//! Behind the gear the torque at one current depends on the speed. The run first measures the torque over rising
//! currents at each speed, in both directions. From these curves the current of each speed is planned during the run.
//! Each measurement begins with a demagnetised brake and a rising current, so that the torque belongs to one branch of
//! the hysteresis. Then the demanded torque is held at all speeds, in random order.

mod curves;
mod identify;

use super::brake_run;
use super::legs::{ACCELERATION, Legs, sample_rate};
use super::{Findable, PlannedSteps, Procedure, ProcedureInfo, findable};
use crate::bench_facts::BenchFacts;
use crate::brake_timing::LAG_S;
use crate::deferred_plan::DeferredPlan;
use crate::findings::verdict;
use crate::identification::Identification;
use crate::parameter::{Parameter, Values};
use crate::plan::{Plan, PlanFault};
use curves::Curves;
use jointbench_instrument::{Kind, RunTable};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

pub(super) struct ConstantLoad;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "constant_load",
    title: "Constant load over speed",
    summary: "Readjusts the brake current at each speed, so that the load torque at the output stays as demanded. \
              Reports the reached torque and the current of each speed.",
    kind: Kind::Brake,
    schema: &[
        Parameter::number(
            "torque_nm",
            "Demanded torque (0: half of the torque at maximum current)",
            "Nm",
            0.0,
            [0.0, 1000.0],
        ),
        Parameter::number("low_speed_rad_s", "Minimum speed (link)", "rad/s", 0.15, [0.11, 10.0]),
        Parameter::number("top_speed_rad_s", "Maximum speed (link)", "rad/s", 1.5, [0.2, 20.0]),
        Parameter::count("speeds", "Number of speeds (logarithmically spaced)", 6, [2, 30]),
        Parameter::fraction("top_current", "Maximum current, relative to rated", 0.9, [0.05, 1.0]),
        Parameter::count("levels", "Currents of the torque curve at each speed", 10, [3, 40]),
        Parameter::count("repeats", "Holds of the torque at each speed and direction", 3, [2, 50]),
        Parameter::number("dwell_s", "Dwell time at each current", "s", 0.9, [0.5, 20.0]),
        Parameter::fraction("bound", "Reached if the torque differs by less than", 0.02, [0.001, 0.5]),
        ACCELERATION,
        sample_rate(100.0),
        Parameter::count("order_seed", "Random seed (order of the speeds)", 1, [0, 1_000_000]),
    ],
};

/// Purpose of a step, stored in the column `repeat`: from the second one on it is the number of the round.
const CURVE: u32 = 1;
/// Name of the fact that contains the parameters, for the planning during the run.
const PARAMETERS: &str = "constant_load";

impl Procedure for ConstantLoad {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let (low, top) = (values.number("low_speed_rad_s"), values.number("top_speed_rad_s"));
        if low >= top {
            return Err(PlanFault::Contradiction {
                what: format!("low_speed_rad_s = {low} must be below top_speed_rad_s = {top}"),
                cure: "swap the two values",
            });
        }
        brake_run::check(bench)?;
        let speeds_rad_s = speeds_rad_s(values, bench);
        let top_a = values.number("top_current") * bench.constants.brake_rated_current_a;
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        legs.demagnetise(speeds_rad_s[speeds_rad_s.len() - 1], top_a, 2.0, bench);
        let first = legs.steps.len() as u32;
        legs.repeat = CURVE;
        let levels = values.count("levels");
        let currents_a: Vec<f64> = (1..=levels).map(|i| top_a * f64::from(i) / f64::from(levels)).collect();
        for speed_rad_s in &speeds_rad_s {
            there_and_back(&mut legs, "torque curve", *speed_rad_s, &currents_a, values.number("dwell_s"));
        }
        let until = legs.steps.len() as u32;
        // The dry run assumes the largest current of the curves, which no readjusted current exceeds.
        let assumed: Vec<(f64, f64)> = speeds_rad_s.iter().map(|speed| (*speed, top_a)).collect();
        hold(&mut legs, values, &assumed);
        let rate_hz = values.number("sample_rate_hz");
        let mut meta = brake_run::meta(bench, rate_hz);
        meta.other.insert(PARAMETERS.into(), Value::Object(values.to_json()));
        let to = until..legs.steps.len() as u32;
        let mut plan = legs.plan(self, values, meta, rate_hz);
        plan.deferred = Some(DeferredPlan { from: first..until, to, earlier: None });
        Ok(plan)
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[
            ("Nm", "demanded reached_#"),
            ("A", "current_# current_constant"),
            ("%", "error_# error_max change change_constant"),
        ])
    }

    fn identify(&self, values: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify::identify(values, run))
    }

    fn plan_deferred(&self, run: &RunTable, bench: &BenchFacts) -> Result<PlannedSteps, String> {
        const FOREIGN: &str = "the parameters are not stored with the run";
        let given = run.meta().other.get(PARAMETERS).and_then(Value::as_object).ok_or(FOREIGN)?;
        let values = Values::parse(INFO.schema, given).map_err(|fault| fault.to_string())?;
        let plan = self.build(&values, bench).map_err(|fault| fault.to_string())?;
        let to = plan.deferred.ok_or(FOREIGN)?.to;
        let speeds_rad_s = speeds_rad_s(&values, bench);
        let curves = Curves::of(run);
        let torque_nm = curves.demanded_nm(&values)?;
        let currents = curves.currents(&speeds_rad_s, torque_nm)?;
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        hold(&mut legs, &values, &currents);
        for (segment, step) in to.zip(&mut legs.steps) {
            step.segment = segment;
        }
        let known = |(speed_rad_s, current_a): &(f64, f64)| {
            format!("{current_a:.3} A at {:.2} rad/s", speed_rad_s / bench.constants.gear_ratio)
        };
        let listed: Vec<String> = currents.iter().map(known).collect();
        Ok(PlannedSteps {
            steps: legs.steps,
            message: format!("The current is readjusted for {torque_nm:.2} Nm: {}", listed.join(", ")),
        })
    }
}

/// Motor-side speeds, the lowest first.
fn speeds_rad_s(values: &Values, bench: &BenchFacts) -> Vec<f64> {
    let (low, top) = (values.number("low_speed_rad_s"), values.number("top_speed_rad_s"));
    let steps = f64::from(values.count("speeds") - 1);
    let speed = |i: u32| bench.constants.gear_ratio * low * (top / low).powf(f64::from(i) / steps);
    (0..values.count("speeds")).map(speed).collect()
}

fn there_and_back(legs: &mut Legs, what: &str, speed_rad_s: f64, currents_a: &[f64], dwell_s: f64) {
    for velocity_rad_s in [speed_rad_s, -speed_rad_s] {
        legs.sweep(format!("{what} at {velocity_rad_s:+.1} rad/s"), velocity_rad_s, currents_a, dwell_s);
    }
}

/// The rounds at motor-side speeds with their currents.
fn hold(legs: &mut Legs, values: &Values, currents: &[(f64, f64)]) {
    let mut rng = ChaCha8Rng::seed_from_u64(u64::from(values.count("order_seed")));
    for round in 1..=values.count("repeats") {
        legs.repeat = CURVE + round;
        let mut order = currents.to_vec();
        order.shuffle(&mut rng);
        for (speed_rad_s, current_a) in order {
            there_and_back(legs, "torque", speed_rad_s, &[current_a], values.number("dwell_s") + LAG_S);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::legs::testing::{joint_a, joint_b};
    use super::*;
    use jointbench_instrument::{Channel, Meta, Trace};
    use serde_json::{Map, json};

    #[test]
    fn every_measurement_begins_demagnetised_and_no_step_exceeds_the_curves() {
        for facts in [joint_a(), joint_b()] {
            let given = json!({"top_speed_rad_s": 1.2}).as_object().unwrap().clone();
            let plan = ConstantLoad.plan(&given, &facts).unwrap();
            assert!(plan.preview(&facts).is_allowed(), "{:?}", plan.preview(&facts).checks);
            let deferred = plan.deferred.as_ref().unwrap();
            assert_eq!((deferred.from.end, deferred.to.end as usize), (deferred.to.start, plan.steps.len()));
            let top_a = 0.9 * facts.constants.brake_rated_current_a;
            for step in &plan.steps[deferred.from.start as usize..] {
                assert!(step.brake.largest() <= top_a + 1e-12 && step.brake.end() == 0.0, "{}", step.label);
                assert_eq!(step.before, crate::plan::InitialState::Demagnetised, "{}", step.label);
            }
        }
    }

    /// A brake with a torque of 20 Nm/A·I and a drag that falls with the speed, at the same current.
    fn curves_of(given: &Map<String, Value>) -> RunTable {
        let plan = ConstantLoad.plan(given, &joint_b()).unwrap();
        let deferred = plan.deferred.as_ref().unwrap();
        let names = [
            "time_s",
            "velocity_setpoint_rad_s",
            "brake_current_command_a",
            "brake_current_a",
            "brake_torque_nm",
            "velocity_rad_s",
            "segment",
            "repeat",
        ];
        let mut trace = Trace::new(names.map(Channel::new).to_vec());
        let mut from_s = 0.0;
        for step in plan.steps.iter().filter(|step| deferred.from.contains(&step.segment)) {
            let rows = (step.duration_s() * 100.0) as u32;
            for row in 0..rows {
                let at_s = f64::from(row) / 100.0;
                let (velocity, current) = (step.velocity.at(at_s), step.brake.at(at_s));
                let torque = 20.0 * current + 2.0 / (1.0 + velocity.abs() / 50.0);
                let (segment, repeat) = (f64::from(step.segment), f64::from(step.repeat));
                trace.push_row(&[from_s + at_s, velocity, current, current, torque, velocity / 50.0, segment, repeat]);
            }
            from_s += step.duration_s();
        }
        RunTable::new(Meta { other: plan.meta.other, ..Meta { kind: Some(Kind::Brake), ..Meta::default() } }, trace)
            .unwrap()
    }

    #[test]
    fn the_current_follows_from_the_curve_of_each_speed() {
        let given = json!({"torque_nm": 5.0, "speeds": 3}).as_object().unwrap().clone();
        let planned = ConstantLoad.plan_deferred(&curves_of(&given), &joint_b()).unwrap();
        let plan = ConstantLoad.plan(&given, &joint_b()).unwrap();
        let to = plan.deferred.unwrap().to;
        assert_eq!(planned.steps.iter().map(|step| step.segment).collect::<Vec<_>>(), to.collect::<Vec<_>>());
        for step in &planned.steps {
            let drag_nm = 2.0 / (1.0 + step.velocity.largest() / 50.0);
            assert!((step.brake.largest() - (5.0 - drag_nm) / 20.0).abs() < 1e-9, "{}", step.label);
        }
        assert!(planned.message.contains("readjusted for 5.00 Nm"), "{}", planned.message);
    }

    #[test]
    fn a_torque_beyond_the_curves_is_refused_with_their_range() {
        let given = json!({"torque_nm": 14.0, "speeds": 3}).as_object().unwrap().clone();
        let run = curves_of(&given);
        let why = ConstantLoad.plan_deferred(&run, &joint_b()).unwrap_err();
        assert!(why.contains("14.00 Nm") && why.contains("rad/s reach"), "{why}");
        let values = Values::parse(INFO.schema, &given).unwrap();
        let found = ConstantLoad.identify(&values, &run).unwrap();
        assert_eq!(found.verdict, crate::identification::Verdict::Inconclusive, "{}", found.summary);
        assert!(found.summary.contains("14.00 Nm"), "{}", found.summary);
    }
}
