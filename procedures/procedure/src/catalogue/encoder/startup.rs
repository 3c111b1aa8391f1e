//! Change of the zero of the encoder under test between power-ups (start-up initialisation error).

use super::offset::step_rad;
use super::series::histogram;
use super::sweeps::{Sweep, sweeps};
use super::{ACCELERATION, both_ways, counts, meta, sample_rate};
use crate::bench_facts::BenchFacts;
use crate::catalogue::legs::Legs;
use crate::catalogue::{Findable, Procedure, ProcedureInfo, findable};
use crate::findings::{Mean, quantity, scatter, spread_ci95};
use crate::identification::{Axis, Figure, Form, Identification, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{InitialState, Plan, PlanFault};
use crate::stage_pose::StagePose;
use crate::thresholds::START_APART;
use jointbench_instrument::{Kind, RunTable};
use jointbench_model::stats::summary::mean;

pub struct EncoderStartup;

/// Pairs of motions at each power-up; their scatter is the repeatability without a power-up.
const PAIRS: u32 = 2;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "encoder_startup",
    title: "Encoder start-up",
    summary: "Switches the encoder under test off and on several times and measures its offset from the index each \
              time. A bench without a power switch waits for the operator before each power-up.",
    kind: Kind::Encoder,
    schema: &[
        Parameter::count("power_ups", "Number of power-ups", 12, [3, 200]),
        Parameter::number("speed_rad_s", "Speed", "rad/s", 4.0, [0.5, 50.0]),
        Parameter::number("turns", "Turns in each direction", "", 1.2, [1.2, 100.0]),
        ACCELERATION,
        sample_rate(250.0),
    ],
};

impl Procedure for EncoderStartup {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn can_resume(&self) -> Result<(), &'static str> {
        Err("the zero of the reference is lost when an instrument is switched off")
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let counts = counts(bench)?;
        let rate_hz = values.number("sample_rate_hz");
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        for power_up in 0..values.count("power_ups") {
            legs.repeat = power_up;
            let first = legs.steps.len();
            for _ in 0..PAIRS {
                both_ways(&mut legs, values.number("speed_rad_s"), values.number("turns"), StagePose::AsLeft);
            }
            legs.steps[first].before = InitialState::PoweredAnew;
        }
        Ok(legs.plan(self, values, meta(counts, rate_hz), rate_hz))
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[("rad", "offset startup_spread startup_range repeatability"), ("", "power_ups")])
    }

    fn identify(&self, _: &Values, run: &RunTable) -> Option<Identification> {
        let (mut zeros, mut within, mut pairs) = (Vec::new(), 0.0, 0.0);
        for power_up in sweeps(run).chunk_by(|a, b| a.repeat == b.repeat) {
            // Delay and hysteresis cancel in the mean of both directions.
            let of_pair = |pair: &[Sweep]| match pair {
                [out, back] => Some(0.5 * (out.shape()?.mean_rad + back.shape()?.mean_rad)),
                _ => None,
            };
            let offsets: Vec<f64> = power_up.chunks(2).filter_map(of_pair).collect();
            if offsets.len() < 2 {
                continue;
            }
            let zero = mean(&offsets);
            within += offsets.iter().map(|offset| (offset - zero).powi(2)).sum::<f64>();
            pairs += offsets.len() as f64 - 1.0;
            zeros.push(zero);
        }
        let (Some(offset), true) = (Mean::of(&zeros), zeros.len() >= 3 && pairs > 0.0) else {
            let what = "The variation is unknown, because fewer than three power-ups were completed.";
            return Some(Identification::inconclusive(what, "Let the run finish."));
        };
        let freedom = zeros.len() as f64 - 1.0;
        let spread = (zeros.iter().map(|zero| (zero - offset.value).powi(2)).sum::<f64>() / freedom).sqrt();
        let repeats_to = (within / pairs).sqrt();
        let ends = |pick: fn(f64, f64) -> f64| zeros.iter().copied().reduce(pick).unwrap_or(0.0);
        let range = ends(f64::max) - ends(f64::min);
        let point_rad = step_rad(run, "test_position_rad");
        let differs = spread > START_APART * repeats_to.max(point_rad / 12_f64.sqrt());
        let summary = match differs {
            true => format!(
                "Zero varies between power-ups: standard deviation {:.1} counts (n = {}), range {:.1} counts. Without \
                 power cycling: {:.2} counts.",
                spread / point_rad,
                zeros.len(),
                range / point_rad,
                repeats_to / point_rad
            ),
            false => format!("The zero does not change over {} power-ups.", zeros.len()),
        };
        let advice = "Measure the offset after each power-up, or use another source for the initial position.";
        Some(Identification {
            verdict: Verdict::Identified,
            summary,
            advice: differs.then(|| advice.into()),
            quantities: vec![
                quantity(["offset", "ξ", "Mean offset from index to zero", "rad"], offset.value, Some(offset.ci95)),
                quantity(
                    ["startup_spread", "σ_ξ", "Standard deviation between power-ups", "rad"],
                    spread,
                    spread_ci95(spread, freedom),
                ),
                quantity(["startup_range", "", "Range between power-ups", "rad"], range, None),
                quantity(
                    ["repeatability", "", "Standard deviation without power cycling", "rad"],
                    repeats_to,
                    spread_ci95(repeats_to, pairs),
                ),
                quantity(["power_ups", "n", "Number of power-ups", ""], zeros.len() as f64, None),
            ],
            figures: figures(&zeros),
            ..Identification::default()
        })
    }
}

fn figures(zeros: &[f64]) -> Vec<Figure> {
    let numbered = zeros.iter().enumerate().map(|(i, zero)| (i as f64 + 1.0, *zero));
    let figure = |name: &str, title: &str, x: Axis, y: Axis, series| Figure {
        name: name.into(),
        title: title.into(),
        form: Form::Cartesian,
        x,
        y,
        series: vec![series],
    };
    let offset = || Axis::of("Test − reference", "rad");
    vec![
        figure(
            "offset_over_power_ups",
            "Offset after each power-up",
            Axis::of("Power-up", ""),
            offset(),
            scatter("offset", numbered),
        ),
        figure(
            "histogram",
            "Histogram of the offset",
            offset(),
            Axis::of("Fraction", ""),
            histogram("power-ups", zeros, 12),
        ),
    ]
}
