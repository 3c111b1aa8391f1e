//! Mounting tolerance of the sensor, and its best position.

use super::edges::{DIRECTIONS, Direction, Found, found};
use super::sweeps::sweeps;
use super::tested;
use super::tolerance::{self, Judgement};
use super::{ACCELERATION, EncoderLinearity, both_ways, counts, meta, radial, sample_rate, stage};
use crate::bench_facts::BenchFacts;
use crate::catalogue::legs::Legs;
use crate::catalogue::{Findable, Procedure, ProcedureInfo, findable};
use crate::findings::{quantity, solve};
use crate::identification::{Axis, Figure, FollowUp, Form, Identification, Mark, Quantity, Series};
use crate::parameter::{Parameter, Values};
use crate::plan::{Plan, PlanFault};
use crate::profile::Profile;
use crate::stage_pose::{Edge, StagePose};
use jointbench_instrument::roles::Pose;
use jointbench_instrument::{Kind, RunTable};
use std::f64::consts::TAU;

pub struct EncoderAlignment;

/// Strides of an edge search before the bisection.
const STRIDES: u32 = 8;
/// Turns in each try: one whole turn with a margin.
const TURNS_WATCHED: f64 = 1.2;
/// Largest duration of a stage move for the predicted duration of the run.
const MOVE_S: f64 = 1.5;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "encoder_alignment",
    title: "Encoder alignment",
    summary: "Moves the sensor along each axis of the stage until the encoder reports inconsistent periods \
              (bisection). This gives the tested tolerance of each axis. Then measures the error over the radial shift \
              and finds its minimum. Align the stage zero with the sensor position first.",
    kind: Kind::Encoder,
    schema: &[
        Parameter::number("radial_reach_m", "Maximum radial shift", "m", 0.42e-3, [1e-5, 5e-3]),
        Parameter::number("axial_reach_m", "Maximum axial shift, away from the ring", "m", 0.9e-3, [1e-5, 5e-3]),
        Parameter::number("vertical_reach_m", "Maximum vertical shift", "m", 1e-3, [1e-5, 5e-3]),
        Parameter::number("rotation_reach_rad", "Maximum rotation", "rad", 0.028, [1e-3, 0.2]),
        Parameter::number("tilt_reach_rad", "Maximum tilt", "rad", 0.035, [1e-3, 0.2]),
        Parameter::count("halvings", "Bisection steps", 4, [0, 12]),
        Parameter::number("speed_rad_s", "Speed", "rad/s", 20.0, [1.0, 200.0]),
        Parameter::number("map_reach_m", "Maximum radial shift of the map", "m", 0.2e-3, [1e-5, 5e-3]),
        Parameter::count("map_positions", "Positions of the map", 5, [3, 50]),
        Parameter::number("map_turns", "Turns in each direction at a position", "", 4.0, [1.0, 100.0]),
        ACCELERATION,
        sample_rate(250.0),
    ],
};

impl Procedure for EncoderAlignment {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let counts = counts(bench)?;
        stage(bench)?;
        let (rate_hz, speed_rad_s) = (values.number("sample_rate_hz"), values.number("speed_rad_s"));
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        for direction in &DIRECTIONS {
            let edge = Edge {
                from: Pose::default(),
                to: direction.pose(values.number(direction.reach)),
                strides: STRIDES,
                halvings: values.count("halvings"),
                dwell_s: TURNS_WATCHED * TAU / speed_rad_s,
            };
            let longest_s = f64::from(edge.tries()) * (edge.dwell_s + MOVE_S);
            let velocity = Profile::plateau(speed_rad_s, legs.acceleration_rad_s2, longest_s);
            legs.push(direction.title.into(), velocity, Profile::constant(0.0));
            if let Some(step) = legs.steps.last_mut() {
                step.place = StagePose::Edge(edge);
            }
        }
        let (reach_m, positions) = (values.number("map_reach_m"), values.count("map_positions"));
        legs.repeat = 1;
        for position in 0..positions {
            let shift_m = reach_m * (2.0 * f64::from(position) / f64::from(positions - 1) - 1.0);
            both_ways(&mut legs, speed_rad_s, values.number("map_turns"), StagePose::At(radial(shift_m)));
        }
        // The sensor is returned to its nominal position after the map.
        both_ways(&mut legs, speed_rad_s, 1.0, StagePose::At(Pose::default()));
        Ok(legs.plan(self, values, meta(counts, rate_hz), rate_hz))
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[
            (
                "m",
                "radial_negative radial_positive axial_positive vertical_negative vertical_positive best_radial_shift \
                 tested_radial tested_axial tested_vertical",
            ),
            (
                "rad",
                "rotation_negative rotation_positive tilt_negative tilt_positive best_harmonic_1 tested_rotation \
                 tested_tilt",
            ),
        ])
    }

    fn identify(&self, _: &Values, run: &RunTable) -> Option<Identification> {
        let found: Vec<(&Direction, Found)> =
            DIRECTIONS.iter().filter_map(|direction| Some((direction, found(run, direction)?))).collect();
        if found.is_empty() {
            let what = "The periods were not consistent at any position away from the stage zero.";
            return Some(Identification::inconclusive(
                what,
                "Align the stage zero with the sensor position, and let the run finish.",
            ));
        }
        let mut quantities: Vec<Quantity> =
            found.iter().filter_map(|(direction, found)| direction.quantity(found)).collect();
        quantities.extend(tested::quantities(&found));
        let map = Map::of(run);
        let judged = Judgement::of(&found);
        let mut lead = format!("{} {}", judged.text, description(&found));
        if let Some(best) = map.as_ref().and_then(Map::best) {
            lead.push_str(&format!(
                " The eccentricity error has its minimum of {:.0} µrad at a radial shift of {:.3} mm.",
                1e6 * best.once_rad,
                1e3 * best.shift_m
            ));
            let name = ["best_radial_shift", "", "Radial shift with the minimum eccentricity error", "m"];
            quantities.push(quantity(name, best.shift_m, Some(best.ci95)));
            let name = ["best_harmonic_1", "", "Eccentricity error at this shift", "rad"];
            quantities.push(quantity(name, best.once_rad, Some(best.once_ci95)));
        }
        let mut figures = vec![tolerance::figure(&found)];
        figures.extend(map.map(|map| map.figure()));
        Some(Identification {
            verdict: judged.verdict,
            summary: format!("{}: {lead}", judged.outcome),
            lead: judged.passes.map(|_| lead),
            advice: judged.advice,
            quantities,
            figures,
            passes: judged.passes,
            ..Identification::default()
        })
    }

    fn follow_up(&self, found: &Identification) -> Option<FollowUp> {
        let best_m = found.quantity("best_radial_shift")?.value;
        // Rounded to a tenth of a micrometre, which is finer than the stage.
        let parameters =
            serde_json::Map::from_iter([("radial_shift_m".to_owned(), ((1e7 * best_m).round() / 1e7).into())]);
        Values::parse(EncoderLinearity.schema(), &parameters).ok()?;
        let why = "move the sensor to this position and measure the linearity; repeat an earlier linearity run to move \
                   it back";
        Some(FollowUp { procedure: EncoderLinearity.id().to_owned(), parameters, why: why.to_owned() })
    }
}

fn description(found: &[(&Direction, Found)]) -> String {
    let (lost, kept): (Vec<_>, Vec<_>) = found.iter().partition(|(_, found)| found.bad.is_some());
    let names = |directions: &[&(&Direction, Found)]| {
        directions.iter().map(|(direction, _)| direction.title).collect::<Vec<_>>().join(", ")
    };
    match (lost.len(), kept.len()) {
        (0, _) => "Period count is not lost within the travel in any direction.".into(),
        (edges, 0) => format!("Period count is lost in all {edges} directions."),
        (edges, _) => {
            format!("Period count is lost in {edges} directions; not lost within the travel: {}.", names(&kept))
        }
    }
}

/// Points of the fitted error in the figure.
const FITTED: u32 = 60;

/// The harmonics of the error over the radial shift.
struct Map {
    shift_m: Vec<f64>,
    once_rad: Vec<[f64; 2]>,
    twice_rad: Vec<f64>,
}

struct Best {
    shift_m: f64,
    ci95: [f64; 2],
    once_rad: f64,
    once_ci95: [f64; 2],
    /// Slope of the error over the shift, far from the best position.
    rad_per_m: f64,
}

impl Map {
    fn of(run: &RunTable) -> Option<Self> {
        let mut map = Self { shift_m: Vec::new(), once_rad: Vec::new(), twice_rad: Vec::new() };
        for sweep in sweeps(run).iter().filter(|sweep| sweep.repeat == 1) {
            let Some(shape) = sweep.shape() else { continue };
            map.shift_m.push(sweep.radial_m);
            map.once_rad.push(shape.once_rad);
            map.twice_rad.push(shape.twice_rad[0].hypot(shape.twice_rad[1]));
        }
        (map.shift_m.len() >= 4).then_some(map)
    }

    /// Eccentricity adds a vector proportional to the shift to the once-per-turn error. The best position is that of
    /// the shortest sum.
    fn best(&self) -> Option<Best> {
        let rows: Vec<[f64; 2]> = self.shift_m.iter().map(|shift| [1.0, *shift]).collect();
        let part = |i: usize| solve(&rows, &self.once_rad.iter().map(|once| once[i]).collect::<Vec<_>>());
        let (cos, sin) = (part(0)?, part(1)?);
        let slope = cos.values[1].hypot(sin.values[1]);
        let along = |once: [f64; 2]| (once[0] * cos.values[1] + once[1] * sin.values[1]) / slope;
        let shift_m = -along([cos.values[0], sin.values[0]]) / slope;
        // The scatter of the vectors along the shift, divided by the slope: the interval of the position where their
        // line crosses zero.
        let line = solve(&rows, &self.once_rad.iter().map(|once| along(*once)).collect::<Vec<_>>())?;
        let n = self.shift_m.len() as f64;
        let mean_m = self.shift_m.iter().sum::<f64>() / n;
        let spread = self.shift_m.iter().map(|shift| (shift - mean_m).powi(2)).sum::<f64>();
        let share = (1.0 / n + (shift_m - mean_m).powi(2) / spread).sqrt();
        let reach_m = line.reach[1] * spread.sqrt() * share / slope;
        // That of both components at this position.
        let reach_rad = cos.reach[1].max(sin.reach[1]) * spread.sqrt() * share;
        let once = [cos.values[0] + cos.values[1] * shift_m, sin.values[0] + sin.values[1] * shift_m];
        let ci95 = [shift_m - reach_m, shift_m + reach_m];
        let once_rad = once[0].hypot(once[1]);
        let once_ci95 = [(once_rad - reach_rad).max(0.0), once_rad + reach_rad];
        Some(Best { shift_m, ci95, once_rad, once_ci95, rad_per_m: slope })
    }

    fn figure(self) -> Figure {
        let once = self.once_rad.iter().map(|once| once[0].hypot(once[1])).collect();
        let fitted = self.best().into_iter().flat_map(|best| {
            let (low, high) =
                self.shift_m.iter().fold((best.shift_m, best.shift_m), |(l, h), x| (l.min(*x), h.max(*x)));
            let places: Vec<f64> =
                (0..=FITTED).map(|i| low + (high - low) * f64::from(i) / f64::from(FITTED)).collect();
            let errors = places.iter().map(|x| best.once_rad.hypot(best.rad_per_m * (x - best.shift_m))).collect();
            [
                Series::new("1 period per turn, fitted", Mark::Line, places, errors).in_group("1 period per turn"),
                Series::new("smallest", Mark::Points, vec![best.shift_m], vec![best.once_rad]),
            ]
        });
        let fitted: Vec<Series> = fitted.collect();
        Figure {
            name: "map".into(),
            title: "Harmonics of the error over the radial shift".into(),
            form: Form::Cartesian,
            x: Axis::of("Radial shift", "m"),
            y: Axis::of("Amplitude", "rad"),
            series: vec![
                Series::new("1 period per turn", Mark::Points, self.shift_m.clone(), once),
                Series::new("2 periods per turn", Mark::Points, self.shift_m, self.twice_rad),
            ]
            .into_iter()
            .chain(fitted)
            .collect(),
        }
    }
}
