//! Trajectories: filtered and decimated samples of continuous motion.
//!
//! Parallel filtering after Gautier 1997, with two zero-phase filters. A light one filters all signals before
//! nonlinear operations. A lower one filters every regressor and the torque before decimation. The motion is derived
//! from the position only, so that no signal has a delay against it.

use crate::preprocess::chunks::MOST_ROWS;
use crate::preprocess::friction::bristles;
use crate::preprocess::friction::layout::Layout;
use crate::preprocess::friction::signals::{Work, filtered, read};
use crate::preprocess::friction::unmeasured_gravity;
use crate::preprocess::{Prepared, sample_s};
use crate::report::fit::{Bristles, Preparation};
use crate::signal::Signal;
use crate::stats::summary::median;
use crate::view::{Constants, View};
use crate::{ModelError, Options, ResidualKind};
use jointbench_instrument::{Motion, RunTable};

/// Corner frequency of the regressor filter [Hz]: bearings, gears and drives of joints resonate above it.
const CUTOFF_HZ: f64 = 6.0;
/// Other corner frequencies that the parameter intervals have to cover, as shares of it.
const OTHER_CUTOFFS: [f64; 2] = [0.5, 5.0 / 3.0];
/// Largest corner frequency as a share of the work rate.
const MOST_OF_RATE: f64 = 0.2;
/// Rows in each period of the corner frequency.
const ROWS: f64 = 4.0;
/// Width of the direction change, as a multiple of the velocity noise, or this share of the fastest speed.
const NOISES: f64 = 2.0;
const LEAST_SPEED: f64 = 1e-4;

pub fn prepare(run: &RunTable, options: &Options, given: Option<&Bristles>) -> Result<Prepared, ModelError> {
    let mut work = read(run)?;
    let rate_hz = 1.0 / work.even.step_s;
    let cutoff_hz = corner(options, rate_hz)?;
    let whole = work.torque.len() as f64 * work.even.step_s * cutoff_hz;
    // A long run is decimated further, down to two rows in each period.
    let rows = ROWS.min((MOST_ROWS as f64 / whole).max(2.0));
    let every = decimation(options, &work, rate_hz / (rows * cutoff_hz));
    let velocity = work.signals.find(Signal::Velocity).unwrap_or_default().to_vec();
    let band = given.map_or_else(|| noise(&velocity, &work, cutoff_hz), |given| given.band_rad_s);
    set_direction(&mut work, &velocity, band);
    let position = work.signals.find(Signal::Position).unwrap_or_default();
    let slides = run.meta().motion == Motion::Linear;
    let of_run = || bristles::reaches(position, &work.turns, work.encoder_step, slides);
    let reaches = given.map_or_else(of_run, |given| given.reaches_rad.clone());
    let states = bristles::states(position, &work.even.starts, &reaches);
    let layout = Layout::new(&work, &states, cutoff_hz, every, run);
    if layout.rows.len() < 24 {
        return Err(ModelError::TooFewSamples { usable: layout.rows.len(), needed: 24, what: "filtered rows" });
    }
    let mut bristles = Bristles { reaches_rad: reaches, weights: Vec::new(), band_rad_s: band };
    bristles.weights = given.map_or_else(|| layout.weights(&work, &run.meta().baseline), |given| given.weights.clone());
    let mut view =
        View::new(work.signals.clone(), work.signals.clone(), Vec::new(), work.even.starts.clone(), work.even.step_s);
    view.constants = constants(&work, &bristles, cutoff_hz, run);
    let others: Vec<Layout> = (OTHER_CUTOFFS.map(|share| share * cutoff_hz).into_iter())
        .filter(|other_hz| *other_hz < MOST_OF_RATE * rate_hz)
        .map(|other_hz| {
            Layout::new(&work, &states, other_hz, (rate_hz / (rows * other_hz)).round().max(1.0) as usize, run)
        })
        .collect();
    let problem = |view: &View| {
        let mut main = layout.problem(&work, view);
        main.bandwidths = others.iter().map(|layout| layout.problem(&work, view)).collect();
        main
    };
    let main = problem(&view);
    let bristled =
        (!states.is_empty()).then(|| problem(&bristled(&view, bristles::direction_state(&states, &bristles))));
    let about = Preparation {
        residual: ResidualKind::Raw,
        sample_rate_hz: 1.0 / sample_s(run.column("time_s").unwrap_or_default()),
        cutoff_hz: Some(cutoff_hz),
        velocity_lag_s: None,
        decimation: every * work.even.every,
        chunk_s: None,
        samples: run.len(),
        rows: main.rows(),
        blocks: main.blocks,
        segments_from: if layout.segment.is_some() { "column" } else { "found" }.into(),
        repeats_from: layout.repeats_from.into(),
        bristles: Some(bristles),
    };
    let data_errors = crate::preprocess::checks::unit_mismatch::data_errors(run);
    let warnings = crate::preprocess::checks::metadata::warnings(run);
    Ok(Prepared { bristled, data_errors, warnings, ..Prepared::of(run, main, about) })
}

/// The corner frequency from the options, or the default if the rate permits it.
fn corner(options: &Options, rate_hz: f64) -> Result<f64, ModelError> {
    let highest_hz = 0.45 * rate_hz;
    match options.cutoff_hz {
        Some(cutoff_hz) if cutoff_hz > highest_hz => Err(ModelError::BadOption {
            option: "cutoff_hz",
            why: format!("the run is judged at {rate_hz:.0} samples in a second: expected at most {highest_hz:.0} Hz"),
        }),
        Some(cutoff_hz) => Ok(cutoff_hz),
        None => Ok(CUTOFF_HZ.min(MOST_OF_RATE * rate_hz)),
    }
}

/// Samples of the work rate in a row, at least one.
fn decimation(options: &Options, work: &Work, default: f64) -> usize {
    let every = options.decimation.map_or(default, |every| every as f64 / work.even.every as f64);
    (every.round() as usize).max(1)
}

/// Sets the direction, which changes within a band of velocities, and the signals that depend on it.
fn set_direction(work: &mut Work, velocity: &[f64], band: f64) {
    let direction = match work.only_direction {
        Some(sign) => vec![sign; velocity.len()],
        None => velocity.iter().map(|w| (w / band).tanh()).collect(),
    };
    work.signals.set(Signal::Direction, direction);
    work.set_stills(band);
    let drive = crate::preprocess::friction::drive(&work.signals, &work.torque);
    work.signals.set(Signal::Drive, drive);
}

/// The view with the state of the presliding elements as the direction.
fn bristled(view: &View, direction_state: Vec<f64>) -> View {
    let mut view = view.clone();
    view.points.set(Signal::Direction, direction_state.clone());
    view.samples.set(Signal::Direction, direction_state);
    view
}

fn constants(work: &Work, bristles: &Bristles, cutoff_hz: f64, run: &RunTable) -> Constants {
    let ends = bristles.reaches_rad.first().zip(bristles.reaches_rad.last());
    Constants {
        slides: run.meta().motion == Motion::Linear,
        rotor_inertia: run.meta().rotor_inertia_kg_m2,
        weight: unmeasured_gravity::unmeasured(&work.signals, &work.torque),
        followed_hz: Some(2.0 * cutoff_hz),
        speeds: Some(work.fastest),
        reaches: ends.map(|(low, high)| [low.max(10.0 * work.slowest_step).min(*high), *high]),
        ..Constants::default()
    }
}

/// Velocity noise between the two corner frequencies.
fn noise(velocity: &[f64], work: &Work, cutoff_hz: f64) -> f64 {
    let smooth = filtered(velocity, &work.even, cutoff_hz, 2);
    let apart = median(velocity.iter().zip(&smooth).map(|(fast, slow)| (fast - slow).abs()));
    (NOISES * 1.4826 * apart).max(LEAST_SPEED * work.fastest).max(f64::MIN_POSITIVE)
}
