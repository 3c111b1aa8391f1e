//! Delay of the encoder under test: its difference to the reference over the speed.

use super::by_speed::{BySpeed, Known, Lines, Point};
use super::sweeps::sweeps;
use super::{ACCELERATION, both_ways, counts, meta, point_rad, sample_rate};
use crate::bench_facts::BenchFacts;
use crate::catalogue::legs::Legs;
use crate::catalogue::{Findable, Procedure, ProcedureInfo, ZERO_IS_LOST, findable};
use crate::findings::quantity;
use crate::identification::{Axis, Figure, Form, Identification, Mark, Series, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{Plan, PlanFault};
use crate::stage_pose::StagePose;
use jointbench_instrument::{Kind, RunTable};

pub struct EncoderDelay;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "encoder_delay",
    title: "Encoder delay",
    summary: "Turns at several speeds in both directions. The slope of the encoder difference over speed is the delay. \
              A second run with the filter of the encoder switched on measures the delay of the filter, and how much \
              it exceeds the data sheet.",
    kind: Kind::Encoder,
    schema: &[
        Parameter::number("top_speed_rad_s", "Maximum speed", "rad/s", 157.0, [5.0, 1256.0]),
        Parameter::count("speeds", "Number of speeds", 3, [2, 20]),
        Parameter::number("dwell_s", "Minimum dwell time at each speed", "s", 1.5, [0.2, 60.0]),
        Parameter::count("repeats", "Repeats", 2, [1, 20]),
        Parameter::number("delay_without_filter_s", "Delay without filter (0: unknown)", "s", 0.0, [0.0, 1e-2]),
        Parameter::number(
            "half_difference_without_filter_s",
            "Half the delay difference of the directions without filter",
            "s",
            0.0,
            [-1e-2, 1e-2],
        ),
        Parameter::number("filter_delay_s", "Filter delay (data sheet)", "s", 10e-6, [0.0, 1e-2]),
        ACCELERATION,
        sample_rate(250.0),
    ],
};

impl Procedure for EncoderDelay {
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
        findable(&[
            ("s", "delay delay_mean half_difference filter_delay delay_# delay_difference_# missing_delay_#"),
            ("rad", "offset hysteresis disparity_#"),
            ("rad/s", "speed_#"),
            ("", "disparity_points_# points_per_rpm_#"),
        ])
    }

    fn identify(&self, values: &Values, run: &RunTable) -> Option<Identification> {
        let points: Vec<Point> =
            sweeps(run).iter().filter_map(|sweep| Some((sweep.speed_rad_s, sweep.shape()?.mean_rad))).collect();
        let Some(lines) = Lines::of(&points) else {
            let what = "Delay and offset cannot be distinguished, because fewer than two speeds were measured in both \
                        directions.";
            return Some(Identification::inconclusive(what, "Let the run finish, with at least two speeds."));
        };
        let solved = lines.solved;
        let [offset_rad, hysteresis_rad, delay_s, half_difference_s] = solved.values;
        let by_speed = BySpeed::of(&points, &lines);
        let [mean_s, mean_reach_s] = by_speed.mean_delay();
        let mut quantities = vec![
            quantity(["delay", "t_d", "Delay of the encoder under test", "s"], delay_s, Some(solved.ci95(2))),
            quantity(["offset", "ξ", "Offset at rest", "rad"], offset_rad, Some(solved.ci95(0))),
            quantity(["hysteresis", "h", "Half the hysteresis", "rad"], hysteresis_rad, Some(solved.ci95(1))),
            quantity(
                ["delay_mean", "Δt", "Mean delay of all speeds, with hysteresis", "s"],
                mean_s,
                Some([mean_s - mean_reach_s, mean_s + mean_reach_s]),
            ),
        ];
        quantities.extend(lines.difference.map(|[value, reach]| {
            let name = ["half_difference", "δ", "Half the difference of the delay, positive − negative direction", "s"];
            quantity(name, value, Some([value - reach, value + reach]))
        }));
        let known = Known {
            without_filter_s: values.number("delay_without_filter_s"),
            half_difference_s: values.number("half_difference_without_filter_s"),
            filter_s: values.number("filter_delay_s"),
        };
        let known = Some(known).filter(|known| known.without_filter_s > 0.0);
        quantities.extend(by_speed.quantities(point_rad(run), known));
        let mut summary = format!("The encoder under test lags by {:.2} µs.", 1e6 * delay_s);
        if lines.differ {
            let [positive, negative] = [1.0, -1.0].map(|sign| 1e6 * (delay_s + sign * half_difference_s));
            summary.push_str(&format!(" Positive direction: {positive:.2} µs, negative direction: {negative:.2} µs."));
        }
        if let Some(known) = known {
            let filter_s = delay_s - known.without_filter_s;
            // The delay without the filter comes from an equal run with the same uncertainty.
            let ends_s = solved.ci95(2).map(|end_s| filter_s + std::f64::consts::SQRT_2 * (end_s - delay_s));
            let name = ["filter_delay", "t_f", "Delay of the filter", "s"];
            quantities.push(quantity(name, filter_s, Some(ends_s)));
            let [low, high] = by_speed.missing_range_s(known).map(|missing_s| 1e6 * missing_s);
            summary.push_str(&format!(
                " The filter contributes {:.2} µs. Its delay minus that of the data sheet ({:.2} µs) is {low:.2} to \
                 {high:.2} µs, depending on the speed.",
                1e6 * filter_s,
                1e6 * known.filter_s
            ));
        }
        let mut figures = vec![figure(&points, &lines)];
        figures.extend(known.map(|known| by_speed.figure(known)));
        Some(Identification { verdict: Verdict::Identified, summary, quantities, figures, ..Identification::default() })
    }
}

/// The encoder difference over speed, with the lines of both directions.
fn figure(points: &[Point], lines: &Lines) -> Figure {
    let speeds: Vec<f64> = points.iter().map(|(v, _)| *v).collect();
    let means: Vec<f64> = points.iter().map(|(_, mean)| *mean).collect();
    let top = speeds.iter().fold(0.0, |top: f64, v| top.max(v.abs()));
    let line: Vec<f64> = [-top, -1e-9, 1e-9, top].to_vec();
    let fitted = line.iter().map(|v| lines.at(*v)).collect();
    Figure {
        name: "disparity".into(),
        title: "Encoder difference over speed".into(),
        form: Form::Cartesian,
        x: Axis::of("Speed", "rad/s"),
        y: Axis::of("Test − reference", "rad"),
        series: vec![
            Series::new("mean over whole turns", Mark::Points, speeds, means),
            Series::new("delay, offset and hysteresis", Mark::Line, line, fitted),
        ],
    }
}
