//! Preprocessing of a run table to problems: response and signals at points, divided into independent blocks.

pub(crate) mod brake;
pub(crate) mod checks;
pub(crate) mod chunks;
pub(crate) mod current_dwells;
pub(crate) mod design;
pub(crate) mod encoder;
pub(crate) mod encoder_count;
pub(crate) mod filter;
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
use crate::effects::changes_direction;
use crate::preprocess::checks::unit_mismatch::DataErrors;
use crate::preprocess::checks::{metadata, sensor_faults, unit_mismatch};
use crate::preprocess::design::replicates::DifferentMotion;
use crate::preprocess::filter::{ABREAST, LowPass};
use crate::preprocess::form_error::FormError;
use crate::preprocess::memo::Memo;
use crate::report::fit::{Bristles, GivenConstant, Preparation};
use crate::signal::Signal;
use crate::stats::summary::{median, range};
use crate::view::View;
use crate::{ModelError, Options, ResidualKind};
use jointbench_instrument::{Kind, Motion, RunTable};
use std::collections::HashSet;
use std::ops::Range;
use std::sync::Arc;

/// The data that a model is fitted to and judged on: the response at points with the signals that may explain it.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Signals at the points, and at the samples behind them.
    pub view: View,
    /// The response at the rows.
    pub target: Vec<f64>,
    /// The response at the samples of the view if rows are means over samples, otherwise empty.
    pub(crate) sampled: Arc<Vec<f64>>,
    /// Converts columns at points to columns at rows, in the same way as the response.
    pub(crate) reduce: Reduce,
    /// Block of each row, numbered from 0: long enough to be independent of the others.
    pub(crate) block: Vec<usize>,
    pub(crate) blocks: usize,
    /// Fold of each row: rows that all others predict together, the repeats of one condition.
    pub(crate) fold: Vec<usize>,
    pub(crate) folds: usize,
    /// Pairs of rows that differ only by noise: the same condition and phase in another repeat.
    pub replicate_pairs: Vec<(usize, usize)>,
    /// Replicate pairs with a different loading history: equal only for a model with hysteresis.
    pub(crate) different_history: HashSet<(usize, usize)>,
    /// Replicate pairs at different link angles, if repeats start at different angles: effects of the angle differ
    /// between them.
    pub(crate) different_angle: HashSet<(usize, usize)>,
    /// Why there are no replicate pairs, if repeats are different motions.
    pub(crate) different_motion: Option<DifferentMotion>,
    /// Number of the segment of each row, from its column or detected.
    pub segment: Vec<i64>,
    /// Number of the repeat of each row; the same everywhere if the run has no repeats.
    pub repeat: Vec<i64>,
    /// Speed and load are constant within a block, so that their changes there are sensor noise.
    pub(crate) settled: bool,
    /// Nuisance columns for the form error, for a run that is judged sample by sample.
    pub(crate) form_error: Option<Arc<FormError>>,
    /// The same run at other filter corners: the difference between them is an uncertainty of the estimate.
    pub(crate) bandwidths: Vec<Problem>,
    /// Solutions of recently fitted models.
    pub(crate) memo: Memo,
}

impl Problem {
    /// Number of rows: points after the reduction, to which the coefficients are fitted.
    pub fn rows(&self) -> usize {
        self.target.len()
    }
}

/// Conversion of columns at points to columns at rows.
#[derive(Debug, Clone)]
pub(crate) enum Reduce {
    /// Points are rows.
    Same,
    /// Every recording is filtered, with its ends extended by `pad` samples, and some samples are kept.
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

/// Sums of squares of larger numbers would overflow.
const LARGEST: f64 = 1e100;

/// Fewer samples are not evaluated.
const SHORTEST: usize = 16;

/// A preprocessed run, for every fit and test.
#[derive(Debug, Clone)]
pub struct Prepared {
    /// Kind of the run, which determines the response.
    pub kind: Kind,
    pub(crate) motion: Motion,
    /// Effects that the test conditions of the run imply.
    pub(crate) baseline: Vec<String>,
    /// The problem for most effects.
    pub main: Problem,
    /// The same with a presliding direction, for models with that effect.
    pub(crate) bristled: Option<Problem>,
    /// Ramps and reversals, if the main problem contains only steady-state motion.
    pub(crate) moving: Option<Problem>,
    /// The slow part of these, where the loading history before a reversal matters.
    pub(crate) memory: Option<Problem>,
    /// Factor from the load in model quantities to the column of the run table.
    pub(crate) load_scale: f64,
    /// Constants of the set-up that were used to compute signals or the response.
    pub(crate) constants: Vec<GivenConstant>,
    /// Columns that contradict each other, in sentences.
    pub(crate) data_errors: DataErrors,
    /// Missing or wrong test conditions, in sentences.
    pub(crate) warnings: Vec<String>,
    pub(crate) about: Preparation,
    /// Rows of the run that are excluded, because their torque was not read.
    pub(crate) excluded: Vec<Range<usize>>,
}

impl Prepared {
    /// A run with one problem, without data errors.
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
            data_errors: DataErrors::default(),
            warnings: Vec::new(),
            about,
            excluded: Vec::new(),
        }
    }

    /// The rows of each steady state of the run, with the number of its segment. Empty for a run that is not evaluated
    /// at steady state.
    pub fn steady_states(&self) -> Vec<(i64, Range<usize>)> {
        let chunks = if self.main.settled { &self.main.view.chunks[..] } else { &[] };
        let mut states: Vec<(i64, Range<usize>)> = Vec::new();
        for (row, chunk) in chunks.iter().enumerate() {
            let chunk = self.row(chunk.start)..self.row(chunk.end - 1) + 1;
            match states.last_mut() {
                // Chunks of one steady state follow each other without a gap.
                Some((segment, rows)) if *segment == self.main.segment[row] && rows.end == chunk.start => {
                    rows.end = chunk.end;
                }
                _ => states.push((self.main.segment[row], chunk)),
            }
        }
        states
    }

    /// Row of the run of a row that was not excluded.
    fn row(&self, kept: usize) -> usize {
        self.excluded.iter().fold(kept, |row, out| if row >= out.start { row + out.len() } else { row })
    }

    /// The problem that a model of these effects is judged on. Presliding replaces the direction by its state.
    pub(crate) fn judged(&self, effects: &[String]) -> &Problem {
        let can_absorb = effects.iter().any(|effect| changes_direction(effect));
        self.bristled.as_ref().filter(|_| can_absorb).unwrap_or(&self.main)
    }

    /// Regimes that the main problem can judge: steady-state means show only steady-state effects.
    pub(crate) fn regimes(&self) -> &'static [Regime] {
        match self.about.residual {
            ResidualKind::PlateauMean => &[Regime::SteadyState],
            ResidualKind::Raw => &[Regime::SteadyState, Regime::Transient, Regime::Hysteresis],
        }
    }

    /// Column name of a signal for users.
    pub(crate) fn column_name(&self, signal: Signal) -> &'static str {
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

    /// Factor from a signal in model quantities to its column.
    pub(crate) fn column_scale(&self, signal: Signal) -> f64 {
        if signal == Signal::Load { self.load_scale } else { 1.0 }
    }

    pub(crate) fn column_unit(&self, signal: Signal) -> String {
        let unit = match signal {
            Signal::Direction | Signal::Repeat => "1",
            Signal::Acceleration => "rad/s²",
            Signal::Jerk => "rad/s³",
            _ => jointbench_instrument::units::unit_of(self.column_name(signal)).unwrap_or("1"),
        };
        self.motion.label(unit)
    }

    pub(crate) fn unit(&self) -> String {
        self.motion.label(self.kind.target_unit())
    }
}

/// Contradictions and missing facts of a run's columns and test conditions, each in a sentence, to be reported before
/// a fit.
pub fn attention(run: &RunTable) -> Vec<String> {
    match run.len() < SHORTEST {
        true => Vec::new(),
        false => unit_mismatch::data_errors(run).all().cloned().chain(metadata::warnings(run)).collect(),
    }
}

/// Preprocesses a run. Deterministic, with a cost linear in the rows.
///
/// # Errors
/// [`ModelError::BadOption`], [`ModelError::TooFewSamples`], [`ModelError::TooLarge`], [`ModelError::Constant`], or
/// [`ModelError::MissingConstant`] for a fact that the meta file lacks.
pub fn prepare(run: &RunTable, options: &Options) -> Result<Prepared, ModelError> {
    prepare_with(run, options, None)
}

/// The same with the presliding elements of another run.
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
    for (channel, values) in columns.filter(|(channel, _)| unknown_columns::is_known(run.kind(), &channel.name)) {
        if let Some(value) = values.iter().find(|v| v.abs() > LARGEST) {
            return Err(ModelError::TooLarge { column: channel.name.clone(), value: *value });
        }
    }
    let (excluded, unread) = sensor_faults::unread(run);
    let kept = run.len() - excluded.iter().map(Range::len).sum::<usize>();
    if excluded.is_empty() || kept < SHORTEST {
        return prepare_rows(run, options, bristles);
    }
    let mut prepared = prepare_rows(&run.without(&excluded), options, bristles)?;
    prepared.warnings.extend(unread.into_iter().map(|text| format!("{text}; these rows are excluded")));
    Ok(Prepared { excluded, ..prepared })
}

/// The same for a run whose rows all have a reading of the torque.
fn prepare_rows(run: &RunTable, options: &Options, bristles: Option<&Bristles>) -> Result<Prepared, ModelError> {
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

/// Whether only rounding changes the values: a channel that was not connected.
fn is_constant(values: &[f64]) -> bool {
    let (low, high) = range(values);
    high - low <= 1e-9 * high.abs().max(low.abs())
}

/// Constants that are used to read a run of the kind.
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

/// Corner frequency of the low-pass filter: from the options, or a tenth of the rate.
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

/// Number of evenly spread samples that determine the typical values of a run.
const INFORMATIVE_ROWS: usize = 65_536;

/// The median time step between samples.
fn sample_s(time_s: &[f64]) -> f64 {
    median(time_s.windows(2).step_by(time_s.len().div_ceil(INFORMATIVE_ROWS)).map(|w| w[1] - w[0]))
}
