//! Delay of the encoder under test: its difference to the reference over the speed (eq. 4.4 and 4.5, tables 4.2 and
//! 4.3 of the thesis).

use super::quantities::{insufficient_data, quantity};
use super::sweeps::sweeps;
use super::{ACCELERATION, both_ways, counts, meta, sample_rate};
use crate::bench_facts::BenchFacts;
use crate::catalogue::legs::Legs;
use crate::catalogue::{Findable, Procedure, findable};
use crate::findings::{Solved, solve, t95};
use crate::identification::{Axis, Figure, Form, Identification, Mark, Quantity, Series, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{Plan, PlanFault};
use crate::stage_pose::StagePose;
use jointbench_instrument::{Kind, RunTable};

pub struct EncoderDelay;

impl Procedure for EncoderDelay {
    fn id(&self) -> &'static str {
        "encoder_delay"
    }

    fn title(&self) -> &'static str {
        "Encoder delay"
    }

    fn summary(&self) -> &'static str {
        "Turns at several speeds in both directions. The slope of the encoder difference over speed is the delay. A \
         second run with the filter of the encoder switched on measures the delay of the filter."
    }

    fn kind(&self) -> Kind {
        Kind::Encoder
    }

    fn schema(&self) -> &'static [Parameter] {
        const {
            &[
                Parameter::number("top_speed_rad_s", "Maximum speed", "rad/s", 157.0, [5.0, 1256.0]),
                Parameter::count("speeds", "Number of speeds", 3, [2, 20]),
                Parameter::number("dwell_s", "Minimum dwell time at each speed", "s", 1.5, [0.2, 60.0]),
                Parameter::count("repeats", "Repeats", 2, [1, 20]),
                Parameter::number("delay_without_filter_s", "Delay without filter (0: unknown)", "s", 0.0, [0.0, 1e-2]),
                ACCELERATION,
                sample_rate(250.0),
            ]
        }
    }

    fn can_resume(&self) -> Result<(), &'static str> {
        Err("the zero of the encoders is lost when an instrument is switched off")
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let counts = counts(bench)?;
        let rate_hz = values.number("sample_rate_hz");
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        let speeds = values.count("speeds");
        for repeat in 0..values.count("repeats") {
            legs.repeat = repeat;
            for speed in 1..=speeds {
                let speed_rad_s = values.number("top_speed_rad_s") * f64::from(speed) / f64::from(speeds);
                let turns = (values.number("dwell_s") * speed_rad_s / std::f64::consts::TAU).max(2.0);
                both_ways(&mut legs, speed_rad_s, turns, StagePose::AsLeft);
            }
        }
        Ok(legs.plan(self, values, meta(counts, rate_hz), rate_hz))
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[("s", "delay filter_delay delay_#"), ("rad", "offset hysteresis disparity_#"), ("rad/s", "speed_#")])
    }

    fn identify(&self, values: &Values, run: &RunTable) -> Option<Identification> {
        let points: Vec<(f64, f64)> =
            sweeps(run).iter().filter_map(|sweep| Some((sweep.speed_rad_s, sweep.shape()?.mean_rad))).collect();
        // Offset, half the hysteresis against the motion, delay.
        let rows: Vec<[f64; 3]> = points.iter().map(|(v, _)| [1.0, -v.signum(), -v]).collect();
        let means: Vec<f64> = points.iter().map(|(_, mean)| *mean).collect();
        let Some(solved) = solve(&rows, &means) else {
            let what = "Delay and offset cannot be distinguished, because fewer than two speeds were measured in both \
                        directions.";
            return insufficient_data(what, "Let the run finish, with at least two speeds.");
        };
        let [offset_rad, hysteresis_rad, delay_s] = solved.values;
        let mut quantities = vec![
            quantity(["delay", "t_d", "Delay of the encoder under test", "s"], delay_s, Some(solved.ci95(2))),
            quantity(["offset", "ξ", "Offset at rest", "rad"], offset_rad, Some(solved.ci95(0))),
            quantity(["hysteresis", "h", "Half the hysteresis", "rad"], hysteresis_rad, Some(solved.ci95(1))),
        ];
        quantities.extend(by_speed(&points, &solved));
        let without_s = values.number("delay_without_filter_s");
        let mut summary = format!("The encoder under test lags by {:.2} µs.", 1e6 * delay_s);
        if without_s > 0.0 {
            let filter_s = delay_s - without_s;
            // The delay without the filter comes from an equal run with the same uncertainty.
            let ends_s = solved.ci95(2).map(|end_s| filter_s + std::f64::consts::SQRT_2 * (end_s - delay_s));
            let name = ["filter_delay", "t_f", "Delay of the filter", "s"];
            quantities.push(quantity(name, filter_s, Some(ends_s)));
            summary.push_str(&format!(" The filter contributes {:.2} µs.", 1e6 * filter_s));
        }
        let speeds: Vec<f64> = points.iter().map(|(v, _)| *v).collect();
        let top = speeds.iter().fold(0.0, |top: f64, v| top.max(v.abs()));
        let line: Vec<f64> = [-top, -1e-9, 1e-9, top].to_vec();
        let fitted = line.iter().map(|v| offset_rad - hysteresis_rad * v.signum() - delay_s * v).collect();
        Some(Identification {
            verdict: Verdict::Identified,
            summary,
            quantities,
            figures: vec![Figure {
                name: "disparity".into(),
                title: "Encoder difference over speed".into(),
                form: Form::Cartesian,
                x: Axis::of("Speed", "rad/s"),
                y: Axis::of("Test − reference", "rad"),
                series: vec![
                    Series::new("mean over whole turns", Mark::Points, speeds, means),
                    Series::new("delay, offset and hysteresis", Mark::Line, line, fitted),
                ],
            }],
            ..Identification::default()
        })
    }
}

/// Largest difference of measured speeds that belong to one set-point, relative.
const SAME_SPEED: f64 = 0.02;

/// Table 4.2: measured speed, encoder difference without the offset, and their ratio, for each set-point. The intervals
/// come from the scatter around the straight line and from the offset.
fn by_speed(points: &[(f64, f64)], solved: &Solved<3>) -> Vec<Quantity> {
    let [offset_rad, hysteresis_rad, delay_s] = solved.values;
    let rest = |(v, mean): &(f64, f64)| mean - (offset_rad - hysteresis_rad * v.signum() - delay_s * v);
    let freedom = points.len() as f64 - 3.0;
    let scatter_rad = (points.iter().map(|point| rest(point).powi(2)).sum::<f64>() / freedom).sqrt();
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let is_same = |a: &(f64, f64), b: &(f64, f64)| (b.0 - a.0).abs() < SAME_SPEED * a.0.abs();
    let mut quantities = Vec::new();
    for (i, repeats) in sorted.chunk_by(is_same).enumerate() {
        let n = repeats.len() as f64;
        let speed_rad_s = repeats.iter().map(|(v, _)| v).sum::<f64>() / n;
        let disparity_rad = repeats.iter().map(|(_, mean)| mean - offset_rad).sum::<f64>() / n;
        let reach_rad = (t95(freedom) * scatter_rad / n.sqrt()).hypot(solved.reach[0]);
        let ends = |value: f64, reach: f64| Some([value - reach, value + reach]);
        let here_s = -disparity_rad / speed_rad_s;
        let found = [
            (["speed", "ω", "Measured speed", "rad/s"], speed_rad_s, None),
            (
                ["disparity", "Δ", "Encoder difference without the offset", "rad"],
                disparity_rad,
                ends(disparity_rad, reach_rad),
            ),
            (["delay", "t_ω", "Delay at this speed", "s"], here_s, ends(here_s, reach_rad / speed_rad_s.abs())),
        ];
        for ([name, symbol, title, unit], value, ci95) in found {
            let words = [&format!("{name}_{}", i + 1), symbol, title, unit];
            quantities.push(quantity(words, value, ci95).in_configuration(&format!("{speed_rad_s:+.1} rad/s")));
        }
    }
    quantities
}
