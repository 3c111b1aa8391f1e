//! Procedures of the encoder bench: a motor turns a reference encoder and the encoder under test.

mod alignment;
mod before_after;
mod by_speed;
mod delay;
mod edges;
mod linearity;
mod offset;
mod reduction;
mod series;
mod spectrum;
mod startup;
mod sweeps;
mod table;
mod tested;
mod tolerance;

pub(super) use alignment::EncoderAlignment;
pub(super) use delay::EncoderDelay;
pub(super) use linearity::EncoderLinearity;
pub(super) use offset::EncoderOffset;
pub(super) use startup::EncoderStartup;

use super::legs::{ACCELERATION, Legs, sample_rate};
use crate::bench_facts::BenchFacts;
use crate::plan::PlanFault;
use crate::profile::Profile;
use crate::stage_pose::StagePose;
use jointbench_instrument::roles::Pose;
use jointbench_instrument::{Kind, Meta, RunTable};
use std::f64::consts::TAU;

/// Settling time of the velocity loop.
const SETTLE_S: f64 = 0.4;

/// Counts in a turn of reference and test encoder.
fn counts(bench: &BenchFacts) -> Result<[f64; 2], PlanFault> {
    let cure = "add [bench.reference_encoder] and [bench.test_encoder] to the bench file";
    bench.encoder_counts.ok_or_else(|| bench.missing("pair of encoders", cure))
}

fn stage(bench: &BenchFacts) -> Result<(), PlanFault> {
    if bench.has_stage {
        return Ok(());
    }
    Err(bench.missing("stage", "add [bench.stage] to the bench file, or leave the radial shift at 0"))
}

fn meta(counts: [f64; 2], rate_hz: f64) -> Meta {
    let bits = |counts: f64| Some(counts.log2().round() as u32);
    Meta {
        kind: Some(Kind::Encoder),
        baseline: ["offset", "delay"].map(String::from).to_vec(),
        sample_rate_hz: Some(rate_hz),
        reference_bits: bits(counts[0]),
        test_bits: bits(counts[1]),
        ..Meta::default()
    }
}

/// Step of the encoder under test; `None` if the run does not state it.
fn point_rad(run: &RunTable) -> Option<f64> {
    run.meta().test_bits.map(|bits| TAU / f64::from(bits).exp2())
}

/// One speed, forwards and backwards, for whole turns each.
fn both_ways(legs: &mut Legs, speed_rad_s: f64, turns: f64, place: StagePose) {
    for speed_rad_s in [speed_rad_s, -speed_rad_s] {
        let dwell_s = SETTLE_S + turns * TAU / speed_rad_s.abs();
        let velocity = Profile::plateau(speed_rad_s, legs.acceleration_rad_s2, dwell_s);
        legs.push(format!("{speed_rad_s:+.1} rad/s"), velocity, Profile::constant(0.0));
        if let Some(step) = legs.steps.last_mut() {
            step.place = place;
        }
    }
}

/// x of the stage.
fn radial(shift_m: f64) -> Pose {
    Pose { shift_m: [shift_m, 0.0, 0.0], ..Pose::default() }
}
