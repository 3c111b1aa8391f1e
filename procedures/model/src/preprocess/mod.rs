//! From a run table to problems: response and view at points, cut into blocks that can be called independent.

pub(crate) mod brake;
pub(crate) mod checks;
pub(crate) mod chunks;
pub(crate) mod current_dwells;
pub(crate) mod design;
pub(crate) mod encoder;
pub mod filter;
pub(crate) mod form_error;
pub(crate) mod friction;
pub(crate) mod held_side;
pub(crate) mod independent_blocks;
pub(crate) mod initial_hysteresis_state;
pub(crate) mod loading_history;
pub(crate) mod memo;
pub(crate) mod residual_acceleration;
pub(crate) mod stiffness;
pub(crate) mod sweeps;
pub(crate) mod unknown_columns;

use crate::effect::Regime;
use crate::preprocess::checks::unit_mismatch::DataErrors;
use crate::preprocess::checks::{metadata, unit_mismatch};
pub use crate::preprocess::design::replicates::Unlike;
pub use crate::preprocess::design::segments::stretches;
use crate::preprocess::filter::{ABREAST, LowPass};
use crate::preprocess::form_error::FormError;
use crate::preprocess::memo::Memo;
use crate::report::fit::{Bristles, GivenConstant, Preparation};
use crate::signal::Signal;
pub use crate::signal::may_cause;
use crate::view::View;
use crate::{ModelError, Options, ResidualKind};
use jointbench_instrument::{Kind, Motion, RunTable};
use std::collections::HashSet;
use std::sync::Arc;

/// What a model is judged on: the response at points with the signals that may explain it.
#[derive(Debug, Clone)]
pub struct Problem {
    pub view: View,
    /// The response at the rows.
    pub target: Vec<f64>,
    /// The response at the samples of the view, where rows are means over these; else nothing.
    pub sampled: Arc<Vec<f64>>,
    /// Columns at points become columns at rows in the way in which the target did.
    pub reduce: Reduce,
    /// Piece of the run to which a row belongs, from 0: long enough to be called independent of the others.
    pub block: Vec<usize>,
    pub blocks: usize,
    /// Rows that are predicted together from all others: the repeats of one condition.
    pub fold: Vec<usize>,
    pub folds: usize,
    /// Rows that should be equal but for noise: the same condition and phase in another repeat.
    pub replicate_pairs: Vec<(usize, usize)>,
    /// Those of them that came there on different ways: equal only where a model knows the ways.
    pub different_history: HashSet<(usize, usize)>,
    /// Those that pass other angles of the link, where repeats begin at others: what depends on the angle is not equal in them.
    pub different_angle: HashSet<(usize, usize)>,
    /// Why there are none, where repeats are different motions.
    pub unlike: Option<Unlike>,
    pub segment: Vec<i64>,
    pub repeat: Vec<i64>,
    /// Speed and load are constant within a block: what they seem to change there is their sensors' noise.
    pub settled: bool,
    /// Nuisance columns for the form error, of a run that is judged sample by sample.
    pub form_error: Option<Arc<FormError>>,
    /// The same run at other corners of its filter: what they differ by nobody knows better.
    pub bandwidths: Vec<Problem>,
    /// Solutions of models of it that were asked for last.
    pub(crate) memo: Memo,
}

impl Problem {
    pub fn rows(&self) -> usize {
        self.target.len()
    }
}

/// How columns at points become columns at rows.
#[derive(Debug, Clone)]
pub enum Reduce {
    /// Points are rows.
    Same,
    /// Every recording is filtered, its ends continued by `pad` samples, and some samples are kept.
    Pick { filter: LowPass, pad: usize, rows: Arc<[usize]>, starts: Arc<[usize]> },
}

impl Reduce {
    pub fn apply(&self, column: Vec<f64>) -> Vec<f64> {
        self.apply_all(vec![column]).into_iter().flatten().collect()
    }

    pub fn apply_all(&self, columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let Reduce::Pick { filter, pad, rows, starts } = self else { return columns };
        let points = columns.first().map_or(0, Vec::len);
        let filtered = |some: &[Vec<f64>]| {
            let mut whole = vec![Vec::with_capacity(points); some.len()];
            for (start, end) in starts.iter().zip(starts.iter().skip(1).chain([&points])) {
                let recording: Vec<&[f64]> = some.iter().map(|c| &c[*start..*end]).collect();
                let smooth = filter.each_both_ways(&recording, *pad);
                whole.iter_mut().zip(smooth).for_each(|(whole, part)| whole.extend(part));
            }
            whole.iter().map(|column| rows.iter().map(|row| column[*row]).collect()).collect::<Vec<Vec<f64>>>()
        };
        columns.chunks(ABREAST).flat_map(filtered).collect()
    }
}

/// Squares of larger numbers, and sums of these, are none any more.
const LARGEST: f64 = 1e100;

/// Fewer samples tell nothing.
const SHORTEST: usize = 16;

/// A run, ready for every fit and every test.
#[derive(Debug, Clone)]
pub struct Prepared {
    pub kind: Kind,
    pub motion: Motion,
    /// Effects that the run's facts take for granted.
    pub baseline: Vec<String>,
    /// What most effects are judged on.
    pub main: Problem,
    /// The same with a direction that bends before it slips: beside an effect of such contacts.
    pub bristled: Option<Problem>,
    /// Ramps and reversals, where the main problem holds settled motion only.
    pub moving: Option<Problem>,
    /// The slow part of the same: what came before a reversal matters there.
    pub memory: Option<Problem>,
    /// Factor from the load as the models see it to the column of the run table.
    pub load_scale: f64,
    /// Facts of the set-up that made signals or the response of the columns.
    pub constants: Vec<GivenConstant>,
    /// Columns that contradict each other, in sentences.
    pub clashes: DataErrors,
    /// What the facts lack or have wrong, in sentences.
    pub doubts: Vec<String>,
    pub about: Preparation,
}

/// The effect beside which the direction bends.
pub(crate) const BENDS: &str = "presliding";

impl Prepared {
    /// Judged on one problem, with nothing wrong in the columns and the facts.
    fn of(run: &RunTable, main: Problem, about: Preparation) -> Self {
        let meta = run.meta();
        Self {
            kind: run.kind(),
            motion: meta.motion,
            baseline: meta.baseline.clone(),
            main,
            bristled: None,
            moving: None,
            memory: None,
            load_scale: meta.gear_ratio.filter(|_| run.kind() == Kind::Friction).unwrap_or(1.0),
            constants: constants(run),
            clashes: DataErrors::default(),
            doubts: Vec::new(),
            about,
        }
    }

    /// What a model of these effects is judged on.
    pub fn judged(&self, effects: &[String]) -> &Problem {
        let bends = effects.iter().any(|effect| effect == BENDS);
        self.bristled.as_ref().filter(|_| bends).unwrap_or(&self.main)
    }

    /// Effects that the main problem can judge: of settled motion those alone that show there.
    pub fn regimes(&self) -> &'static [Regime] {
        match self.about.residual {
            ResidualKind::PlateauMean => &[Regime::SteadyState],
            ResidualKind::Raw => &[Regime::SteadyState, Regime::Transient, Regime::Hysteresis],
        }
    }

    /// The column that a signal was, for people.
    pub fn column_name(&self, signal: Signal) -> &'static str {
        match (signal, self.kind) {
            (Signal::Time, _) => "time_s",
            (Signal::Position, Kind::Encoder) => "reference_position_rad",
            (Signal::Position, Kind::Brake) => "position_rad",
            (Signal::Position, _) => "motor_position_rad",
            (Signal::Velocity, Kind::Friction) => "motor_velocity_rad_s",
            (Signal::Velocity, Kind::Stiffness) => "link_velocity_rad_s",
            (Signal::Velocity, _) => "velocity_rad_s",
            (Signal::Acceleration, _) => "acceleration_rad_s2",
            (Signal::Jerk, _) => "jerk_rad_s3",
            (Signal::Direction, _) => "direction",
            (Signal::Link, _) => "link_position_rad",
            (Signal::Load, _) => "link_torque_nm",
            (Signal::Temperature, _) => "temperature_c",
            (Signal::Current, _) => "brake_current_a",
            (Signal::Drive, Kind::Brake) => "brake_torque_nm",
            (Signal::Drive, _) => "motor_torque_nm",
            (Signal::Repeat, _) => "repeat",
            (Signal::Column(column), _) => column,
        }
    }

    /// Factor from a signal as the models see it to its column.
    pub fn column_scale(&self, signal: Signal) -> f64 {
        if signal == Signal::Load { self.load_scale } else { 1.0 }
    }

    pub fn column_unit(&self, signal: Signal) -> String {
        let unit = match signal {
            Signal::Direction | Signal::Repeat => "1",
            Signal::Acceleration => "rad/s²",
            Signal::Jerk => "rad/s³",
            _ => jointbench_instrument::units::unit_of(self.column_name(signal)).unwrap_or("1"),
        };
        self.motion.label(unit)
    }

    pub fn unit(&self) -> String {
        self.motion.label(self.kind.target_unit())
    }
}

/// What a run's columns and facts contradict or lack, each in a sentence: to be told before anything is fitted.
pub fn attention(run: &RunTable) -> Vec<String> {
    match run.len() < SHORTEST {
        true => Vec::new(),
        false => unit_mismatch::clashes(run).all().cloned().chain(metadata::doubts(run)).collect(),
    }
}

/// Prepares a run. Deterministic; cost linear in the rows.
pub fn prepare(run: &RunTable, options: &Options) -> Result<Prepared, ModelError> {
    prepare_with(run, options, None)
}

/// The same with bristles that another run has told.
pub(crate) fn prepare_with(
    run: &RunTable,
    options: &Options,
    bristles: Option<&Bristles>,
) -> Result<Prepared, ModelError> {
    options.check()?;
    if run.len() < SHORTEST {
        return Err(ModelError::TooFewSamples { usable: run.len(), needed: SHORTEST, what: "samples" });
    }
    let columns = run.trace().channels().iter().zip(run.trace().columns());
    for (channel, values) in columns {
        if let Some(value) = values.iter().find(|v| v.abs() > LARGEST) {
            return Err(ModelError::TooLarge { column: channel.name.clone(), value: *value });
        }
    }
    let (prepared, response) = match run.kind() {
        Kind::Friction => (friction::prepare(run, options, bristles)?, "motor_current_a"),
        Kind::Encoder => (encoder::prepare(run, options)?, "test_position_rad − reference_position_rad"),
        Kind::Stiffness => (stiffness::prepare(run, options)?, "motor_position_rad / gear_ratio − link_position_rad"),
        Kind::Brake => (brake::prepare(run, options)?, "brake_torque_nm"),
    };
    match is_constant(&prepared.main.target) {
        true => Err(ModelError::Constant { column: response.into() }),
        false => Ok(prepared),
    }
}

/// Nothing but rounding changes: a channel that was not connected.
fn is_constant(values: &[f64]) -> bool {
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    high - low <= 1e-9 * high.abs().max(low.abs())
}

/// Facts that a run of the kind is read with.
fn constants(run: &RunTable) -> Vec<GivenConstant> {
    let meta = run.meta();
    let count = |name, number: Option<u32>| (name, number.map(f64::from));
    let read = match run.kind() {
        Kind::Friction => vec![
            ("torque_constant_nm_per_a", meta.torque_constant_nm_per_a),
            ("gear_ratio", Some(meta.gear_ratio.unwrap_or(1.0))),
        ],
        Kind::Stiffness => vec![("gear_ratio", meta.gear_ratio)],
        Kind::Encoder => vec![count("pole_pairs", meta.pole_pairs), count("poles", meta.poles)],
        Kind::Brake => vec![count("poles", meta.poles)],
    };
    let given = |(name, value): (&str, Option<f64>)| Some(GivenConstant { name: name.into(), value: value? });
    read.into_iter().filter_map(given).collect()
}

/// Corner of the low-pass filter: what was asked for, or a tenth of the rate.
fn cutoff_hz(options: &Options, step_s: f64) -> Result<f64, ModelError> {
    let highest_hz = 0.45 / step_s;
    match options.cutoff_hz {
        Some(cutoff_hz) if cutoff_hz > highest_hz => Err(ModelError::BadOption {
            option: "cutoff_hz",
            why: format!("these are {:.0} samples in a second: expected at most {highest_hz:.0} Hz", 1.0 / step_s),
        }),
        Some(cutoff_hz) => Ok(cutoff_hz),
        None => Ok(0.1 / step_s),
    }
}

/// So many samples, evenly spread, tell what is usual in a run.
const TELLING: usize = 65_536;

/// The middle value of the step from sample to sample.
fn sample_s(time_s: &[f64]) -> f64 {
    median(time_s.windows(2).step_by(time_s.len().div_ceil(TELLING)).map(|w| w[1] - w[0]))
}

pub(crate) fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
