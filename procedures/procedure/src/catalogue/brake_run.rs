//! Shared functions of the brake procedures: requirements on the bench, and the facts of a brake run.

use super::legs::RANGE_SHARE;
use crate::bench_facts::BenchFacts;
use crate::plan::PlanFault;
use jointbench_instrument::{Kind, Meta, RunTable};
use serde_json::Value;

/// Names of facts of the bench that a brake run stores.
const RATED_TORQUE: &str = "rated_torque_nm";
const LOAD_GEAR_RATIO: &str = "load_gear_ratio";

pub(super) fn check(bench: &BenchFacts) -> Result<(), PlanFault> {
    bench.check_load("connect it, because the brake is measured with the torque sensor")
}

pub(super) fn meta(bench: &BenchFacts, rate_hz: f64) -> Meta {
    let mut meta = Meta {
        kind: Some(Kind::Brake),
        baseline: ["drag", "torque_per_current"].map(str::to_owned).into(),
        sample_rate_hz: Some(rate_hz),
        gear_ratio: Some(bench.constants.gear_ratio),
        rated_current_a: Some(bench.constants.brake_rated_current_a),
        ..Meta::default()
    };
    meta.other.insert(RATED_TORQUE.into(), bench.constants.brake_rated_torque_nm.into());
    if let Some(ratio) = bench.constants.load_gear_ratio {
        meta.other.insert(LOAD_GEAR_RATIO.into(), ratio.into());
    }
    meta
}

fn fact(run: &RunTable, name: &str) -> Option<f64> {
    run.meta().other.get(name).and_then(Value::as_f64)
}

/// Torque of the brake at rated current, from the bench description.
pub(super) fn rated_nm(run: &RunTable) -> Option<f64> {
    fact(run, RATED_TORQUE)
}

/// Turns of the brake for each turn of the link.
pub(super) fn load_gear_ratio(run: &RunTable) -> f64 {
    fact(run, LOAD_GEAR_RATIO).unwrap_or(1.0)
}

/// The desired motor speed, or the highest one at which a step of `duration_s` stays within the link's range.
pub(super) fn speed_rad_s(wanted_rad_s: f64, duration_s: f64, bench: &BenchFacts) -> f64 {
    let room_rad = bench.constants.link_range_rad.map_or(f64::INFINITY, |range_rad| RANGE_SHARE * range_rad);
    wanted_rad_s.min(room_rad * bench.constants.gear_ratio / duration_s)
}
