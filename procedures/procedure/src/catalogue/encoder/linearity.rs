//! Shape of the error over the turn, the look-up table for it, and the remaining precision (figs 4.4 to 4.11).

use super::before_after::{Left, Stage, figures};
use super::reduction::Reduction;
use super::spectrum::PolePairs;
use super::sweeps::{Sweep, sweeps};
use super::table::{Class, Table, Terms, means};
use super::{ACCELERATION, both_ways, counts, meta, point_rad, radial, sample_rate, stage};
use crate::bench_facts::BenchFacts;
use crate::catalogue::legs::Legs;
use crate::catalogue::{Findable, Procedure, ProcedureInfo, ZERO_IS_LOST, findable};
use crate::findings::{jackknife95, quantity, solve};
use crate::identification::{Identification, Quantity, SeriesRole, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{Plan, PlanFault};
use crate::stage_pose::StagePose;
use crate::thresholds::TARGET_BITS;
use jointbench_instrument::{Kind, RunTable};
use jointbench_model::stats::summary::mean;
use std::f64::consts::TAU;

pub struct EncoderLinearity;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "encoder_linearity",
    title: "Encoder linearity",
    summary: "Measures the error over the turn at two speeds in both directions. Builds a look-up table and reports \
              the usable bits without and with it, on validation data.",
    kind: Kind::Encoder,
    schema: &[
        Parameter::number("speed_rad_s", "Slow speed", "rad/s", 5.0, [0.5, 50.0]),
        Parameter::number("fast_rad_s", "Fast speed (for the velocity term)", "rad/s", 50.0, [1.0, 1256.0]),
        Parameter::number("turns", "Turns in each direction", "", 8.0, [1.0, 200.0]),
        Parameter::count("repeats", "Repeats (every second one is used for validation)", 2, [2, 20]),
        Parameter::count("table_size", "Entries of the look-up table", 1024, [32, 16_384]),
        Parameter::number("radial_shift_m", "Radial shift of the stage", "m", 0.0, [-5e-4, 5e-4]),
        ACCELERATION,
        sample_rate(1000.0),
    ],
};

impl Procedure for EncoderLinearity {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn can_resume(&self) -> Result<(), &'static str> {
        Err(ZERO_IS_LOST)
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let counts = counts(bench)?;
        let rate_hz = values.number("sample_rate_hz");
        let shift_m = values.number("radial_shift_m");
        // With a stage, the position 0 is also commanded, because an earlier run may have moved the sensor.
        let place = if shift_m == 0.0 && !bench.has_stage {
            StagePose::AsLeft
        } else {
            stage(bench)?;
            StagePose::At(radial(shift_m))
        };
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        for repeat in 0..values.count("repeats") {
            legs.repeat = repeat;
            for speed in ["speed_rad_s", "fast_rad_s"] {
                both_ways(&mut legs, values.number(speed), values.number("turns"), place);
            }
        }
        Ok(legs.plan(self, values, meta(counts, rate_hz), rate_hz))
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[
            (
                "",
                "bits_before bits_table bits_velocity bits_direction pole_period_order table_error_mean_points \
                 table_error_max_points",
            ),
            (
                "rad",
                "repeatability peak_before peak_table peak_velocity peak_direction harmonic_1 harmonic_2 pole_period \
                 table_error_mean table_error_max",
            ),
        ])
    }

    fn identify(&self, values: &Values, run: &RunTable) -> Option<Identification> {
        let (known, unseen): (Vec<Sweep>, Vec<Sweep>) =
            sweeps(run).into_iter().partition(|sweep| sweep.repeat % 2 == 0);
        if known.len() < 4 || unseen.len() < 2 {
            let what =
                "The run lacks two speeds in both directions for the estimation, or further turns for the validation.";
            return Some(Identification::inconclusive(what, "Let the run finish, with at least two repeats."));
        }
        let Some(terms) = Terms::of(&known) else {
            return Some(Identification::inconclusive(
                "Offset, hysteresis and delay cannot be distinguished.",
                "Choose two different speeds.",
            ));
        };
        let Some(table) = Table::of(&known, &terms, values.count("table_size") as usize) else {
            let what = "More than 10 % of the table entries contain no data.";
            return Some(Identification::inconclusive(
                what,
                "Choose more turns, a higher sample rate or a smaller table.",
            ));
        };
        let before = |sweep: &Sweep, i: usize| sweep.error_rad[i] - terms.offset_rad;
        let direct = |sweep: &Sweep, i: usize| before(sweep, i) - table.at(sweep.angle_rad[i] + sweep.error_rad[i]);
        let delayed = |sweep: &Sweep, i: usize| direct(sweep, i) + terms.delay_s * sweep.speed_rad_s;
        let full = |sweep: &Sweep, i: usize| delayed(sweep, i) + terms.hysteresis_rad * sweep.speed_rad_s.signum();
        let peaks = peaks(&unseen, [&before, &direct, &delayed, &full]);
        let poles = PolePairs::of(&table)?;
        let compared: [Stage; 2] = [("before", SeriesRole::Before, &before), ("after", SeriesRole::After, &full)];
        let figures = figures(&unseen, &table, &poles, compared);
        let mut quantities = usable(peaks);
        quantities.extend(repeatability(&known, &unseen));
        quantities.extend(harmonics(&known, &terms));
        quantities.extend(pole_period(&poles));
        quantities.extend(Reduction::of(&table, &known, &terms).quantities(point_rad(run)));
        Some(Identification {
            verdict: Verdict::Identified,
            summary: summary(peaks.map(|peak| bits(peak.rad)), table.len(), &poles),
            advice: poles.or.map(|_| {
                "To determine the number of pole pairs, use more turns and a larger table: jointbench run \
                 encoder_linearity --set turns=32 --set table_size=4096."
                    .into()
            }),
            quantities,
            figures,
            ..Identification::default()
        })
    }
}

/// Maximum error (rad) that a stage of the compensation leaves in the validation data.
#[derive(Clone, Copy)]
struct Peak {
    rad: f64,
    /// By a jackknife over the turns of each sweep; `None` below three turns.
    ci95: Option<[f64; 2]>,
}

impl Peak {
    fn of(classes: &[Class], left: Left) -> Self {
        let without = |turn| classes.iter().map(|class| class.peak(left, turn)).fold(0.0, f64::max);
        let (rad, turns) = (without(None), classes.iter().map(Class::turns).min().unwrap_or(0));
        if turns < 3 {
            return Self { rad, ci95: None };
        }
        let reach = jackknife95(&(0..turns).map(|turn| without(Some(turn))).collect::<Vec<f64>>());
        Self { rad, ci95: Some([rad - reach, rad + reach]) }
    }

    /// Usable bits of a turn: a larger error leaves fewer. A lower end of no error bounds nothing.
    fn bits(&self) -> (f64, Option<[f64; 2]>) {
        let ends = self.ci95.filter(|[low, _]| *low > 0.0).map(|[low, high]| [bits(high), bits(low)]);
        (bits(self.rad), ends)
    }
}

fn peaks(unseen: &[Sweep], stages: [Left; 4]) -> [Peak; 4] {
    let classes: Vec<Class> = unseen.iter().map(Class::of).collect();
    stages.map(|left| Peak::of(&classes, left))
}

/// Usable bits of a turn with this maximum error.
fn bits(peak_rad: f64) -> f64 {
    (TAU / peak_rad).log2()
}

/// Usable bits and maximum error of each stage.
fn usable(peaks: [Peak; 4]) -> Vec<Quantity> {
    let stages = [
        ("before", "without compensation (INL)"),
        ("table", "with the look-up table"),
        ("velocity", "with table and velocity term"),
        ("direction", "with table, velocity and direction term"),
    ];
    let of_stage = |((name, title), peak): ((&str, &str), Peak)| {
        let (bits_name, peak_name) = (format!("bits_{name}"), format!("peak_{name}"));
        let (bits, bits_ci95) = peak.bits();
        [
            quantity([&bits_name, "", &format!("Usable bits {title}"), ""], bits, bits_ci95),
            quantity([&peak_name, "", &format!("Maximum error {title}"), "rad"], peak.rad, peak.ci95),
        ]
    };
    stages.into_iter().zip(peaks).flat_map(of_stage).collect()
}

fn pole_period(poles: &PolePairs) -> [Quantity; 2] {
    let (amplitude, order) = (poles.amplitude_rad, f64::from(poles.order));
    [
        quantity(["pole_period", "", "Maximum error within a pole pair", "rad"], amplitude, None),
        quantity(["pole_period_order", "", "Pole pairs (periods per turn)", ""], order, None),
    ]
}

fn summary([before, table, velocity, direction]: [f64; 4], entries: usize, poles: &PolePairs) -> String {
    format!(
        "Usable resolution: {before:.1} bits uncompensated, {table:.1} with a look-up table of {entries} entries, \
         {velocity:.1} with the velocity term added, {direction:.1} with the direction term added. {} {}",
        what_it_takes(velocity, direction),
        poles.text()
    )
}

/// Whether table and velocity, without the direction, are sufficient for the required bits.
fn what_it_takes(without_direction: f64, full: f64) -> String {
    match (without_direction >= TARGET_BITS, full >= TARGET_BITS) {
        (true, _) => format!("Table and velocity term are sufficient for {TARGET_BITS} bits."),
        (false, true) => format!("{TARGET_BITS} bits require the direction term."),
        (false, false) => format!("{TARGET_BITS} bits are not reached, not even with the direction term."),
    }
}

/// Angles of the turn at which repeats are compared.
const PLACES: usize = 180;

/// Repeatability of the error at one angle, speed and direction. `None` for a single repeat.
fn repeatability(known: &[Sweep], unseen: &[Sweep]) -> Option<Quantity> {
    let mut sweeps: Vec<&Sweep> = known.iter().chain(unseen).collect();
    sweeps.sort_by(|a, b| a.speed_rad_s.total_cmp(&b.speed_rad_s));
    let (mut squares, mut freedom) = (0.0, 0.0);
    for alike in
        sweeps.chunk_by(|a, b| b.speed_rad_s - a.speed_rad_s < 0.1 * b.speed_rad_s.abs().max(a.speed_rad_s.abs()))
    {
        let error = |sweep: &Sweep, i: usize| sweep.error_rad[i];
        let each: Vec<_> = alike.iter().map(|sweep| means(std::iter::once(*sweep), PLACES, &error)).collect();
        for place in 0..PLACES {
            let seen: Vec<f64> = each.iter().filter_map(|means| means[place]).collect();
            let mean = mean(&seen);
            squares += seen.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
            freedom += seen.len().saturating_sub(1) as f64;
        }
    }
    let title = "Repeatability: standard deviation at one place of the turn";
    (freedom > 0.0).then(|| quantity(["repeatability", "s", title, "rad"], (squares / freedom).sqrt(), None))
}

/// Amplitudes of the two lowest harmonics with their intervals.
fn harmonics(known: &[Sweep], terms: &Terms) -> Vec<Quantity> {
    let mut rows = Vec::new();
    let mut errors = Vec::new();
    for sweep in known {
        for (angle, error) in sweep.angle_rad.iter().zip(&sweep.error_rad) {
            rows.push([1.0, angle.cos(), angle.sin(), (2.0 * angle).cos(), (2.0 * angle).sin()]);
            errors.push(error - terms.at(sweep.speed_rad_s));
        }
    }
    let Some(solved) = solve(&rows, &errors) else { return Vec::new() };
    let amplitude = |first: usize, name: [&str; 4]| {
        let value = solved.values[first].hypot(solved.values[first + 1]);
        let reach = solved.reach[first].max(solved.reach[first + 1]);
        quantity(name, value, Some([value - reach, value + reach]))
    };
    vec![
        amplitude(1, ["harmonic_1", "", "Eccentricity error (1 period per turn)", "rad"]),
        amplitude(3, ["harmonic_2", "", "Tilt or ellipticity error (2 periods per turn)", "rad"]),
    ]
}
