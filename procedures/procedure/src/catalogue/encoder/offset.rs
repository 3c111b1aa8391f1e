//! Zero offset of the encoder under test relative to the reference.

use super::series::{histogram, scatter};
use super::sweeps::{Sweep, sweeps};
use super::{ACCELERATION, both_ways, counts, meta, sample_rate};
use crate::bench_facts::BenchFacts;
use crate::catalogue::legs::Legs;
use crate::catalogue::{Findable, Procedure, ProcedureInfo, ZERO_IS_LOST, findable};
use crate::findings::{quantity, t95};
use crate::identification::{Axis, Figure, Form, Identification, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{Plan, PlanFault};
use crate::stage_pose::StagePose;
use jointbench_instrument::{Kind, RunTable};
use std::f64::consts::TAU;

pub struct EncoderOffset;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "encoder_offset",
    title: "Encoder offset",
    summary: "Turns slowly in both directions and averages the difference of both encoders (wrap-around handled). \
              Repeat it after a power-up, because the offset can change.",
    kind: Kind::Encoder,
    schema: &[
        Parameter::number("speed_rad_s", "Speed", "rad/s", 4.0, [0.5, 50.0]),
        Parameter::number("turns", "Turns in each direction", "", 2.0, [1.0, 100.0]),
        Parameter::count("repeats", "Repeats", 4, [2, 50]),
        ACCELERATION,
        sample_rate(250.0),
    ],
};

impl Procedure for EncoderOffset {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn can_resume(&self) -> Result<(), &'static str> {
        Err(ZERO_IS_LOST)
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let counts = counts(bench)?;
        let rate_hz = values.number("sample_rate_hz");
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        for repeat in 0..values.count("repeats") {
            legs.repeat = repeat;
            both_ways(&mut legs, values.number("speed_rad_s"), values.number("turns"), StagePose::AsLeft);
        }
        Ok(legs.plan(self, values, meta(counts, rate_hz), rate_hz))
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[("rad", "offset direction_difference"), ("", "offset_points positions")])
    }

    fn identify(&self, _: &Values, run: &RunTable) -> Option<Identification> {
        let sweeps = sweeps(run);
        let way = |sign: f64| sweeps.iter().filter(move |sweep| sweep.speed_rad_s * sign > 0.0);
        // Delay and hysteresis cancel in the mean of both directions.
        let pairs: Vec<[f64; 2]> = way(1.0)
            .zip(way(-1.0))
            .filter_map(|(up, down)| Some([up.shape()?.mean_rad, down.shape()?.mean_rad]))
            .collect();
        if pairs.len() < 2 {
            let what = "The scatter is unknown, because fewer than two turns in each direction were measured.";
            return Some(Identification::inconclusive(what, "Let the run finish, with at least two repeats."));
        }
        let (offset_rad, offset_reach) = mean(pairs.iter().map(|[up, down]| 0.5 * (up + down)));
        let (apart_rad, apart_reach) = mean(pairs.iter().map(|[up, down]| up - down));
        let positions: usize = sweeps.iter().map(|sweep| sweep.error_rad.len()).sum();
        let around = |value: f64, reach: f64| Some([value - reach, value + reach]);
        let step_rad = step_rad(run, "test_position_rad");
        let half_rad = 0.5 * (self::step_rad(run, "reference_position_rad") - step_rad);
        let points = offset_rad / step_rad;
        Some(Identification {
            verdict: Verdict::Identified,
            summary: format!(
                "Offset of the encoder under test: {:.3} mrad ({points:.1} counts) over {positions} positions in both \
                 directions. The offset refers to the code transitions of the reference; referred to raw readings \
                 (truncated) it is {:.3} mrad.",
                1e3 * offset_rad,
                1e3 * (offset_rad + half_rad)
            ),
            advice: Some("Repeat the measurement after the next power-up, because the offset can change.".into()),
            quantities: vec![
                quantity(
                    ["offset", "ξ", "Offset, test − reference", "rad"],
                    offset_rad,
                    around(offset_rad, offset_reach),
                ),
                quantity(
                    ["offset_points", "ξ", "Offset in counts (LSB) of the encoder under test", ""],
                    points,
                    around(points, offset_reach / step_rad),
                ),
                quantity(
                    ["direction_difference", "Δξ", "CCW − CW, delay and hysteresis", "rad"],
                    apart_rad,
                    around(apart_rad, apart_reach),
                ),
                quantity(["positions", "n", "Number of positions", ""], positions as f64, None),
            ],
            figures: figures(&sweeps),
            ..Identification::default()
        })
    }
}

/// Mean and half width of its 95 % interval.
fn mean(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let values: Vec<f64> = values.collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, t95(n - 1.0) * (variance / n).sqrt())
}

/// One count of an encoder.
pub(super) fn step_rad(run: &RunTable, column: &str) -> f64 {
    let channel = run.trace().channels().iter().find(|channel| channel.name == column);
    channel.and_then(|channel| channel.resolution).unwrap_or(TAU / 262_144.0)
}

fn figures(sweeps: &[Sweep]) -> Vec<Figure> {
    let of = |sign: f64, label: &str| {
        let way = || sweeps.iter().filter(move |sweep| sweep.speed_rad_s * sign > 0.0);
        let angle: Vec<f64> = way().flat_map(|sweep| &sweep.angle_rad).map(|angle| angle.rem_euclid(TAU)).collect();
        let error: Vec<f64> = way().flat_map(|sweep| &sweep.error_rad).copied().collect();
        scatter(label, &angle, &error)
    };
    let all: Vec<f64> = sweeps.iter().flat_map(|sweep| &sweep.error_rad).copied().collect();
    vec![
        Figure {
            name: "difference".into(),
            title: "Difference of the encoders".into(),
            form: Form::Cartesian,
            x: Axis::of("Angle", "rad"),
            y: Axis::of("Test − reference", "rad"),
            series: vec![of(1.0, "forwards"), of(-1.0, "backwards")],
        },
        Figure {
            name: "histogram".into(),
            title: "Histogram of the difference".into(),
            form: Form::Cartesian,
            x: Axis::of("Test − reference", "rad"),
            y: Axis::of("Fraction", ""),
            series: vec![histogram("all positions", &all, 40)],
        },
    ]
}
