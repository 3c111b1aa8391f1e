//! Runs in legs without steady states: every sample counts, averaged over short chunks.

use crate::hysteresis_operators;
use crate::linear::Basis;
use crate::preprocess::chunks::{Layout, MOST_ROWS, Source, problem};
use crate::preprocess::design::blocks;
use crate::preprocess::design::replicates::Same;
use crate::preprocess::{Prepared, Problem, current_dwells, initial_hysteresis_state, loading_history};
use crate::report::fit::Preparation;
use crate::signal::Signal;
use crate::stats::summary::peak;
use crate::thresholds::{SAME_LEVEL, SMALL_LEVEL};
use crate::{ModelError, Options, ResidualKind};
use jointbench_instrument::{Kind, RunTable};
use std::ops::Range;

pub fn prepare(
    run: &RunTable,
    samples: Source,
    chunk_s: f64,
    inputs: &[Same],
    options: &Options,
) -> Result<Prepared, ModelError> {
    let raw = options.residual == Some(ResidualKind::Raw);
    let n = if raw { 1 } else { samples.chunk(options.chunk_s.unwrap_or(chunk_s)) };
    let layout = layout(&samples, run, inputs, n, raw)?;
    let mut main = problem(&samples, layout);
    let mut warnings = crate::preprocess::checks::metadata::warnings(run);
    warnings.extend(past(&mut main, run.kind()));
    if run.kind() == Kind::Brake {
        let drive = brake_torque_of_current(&main);
        main.view.points.set(Signal::Drive, drive);
        loading_history::part(&mut main);
    }
    let repeats_from = match main.repeat.iter().any(|r| *r != main.repeat[0]) {
        true => "column",
        false if main.replicate_pairs.is_empty() => "none",
        false => "found",
    };
    let residual = if raw { ResidualKind::Raw } else { ResidualKind::PlateauMean };
    let about = Preparation { residual, ..samples.preparation_of_chunks(n, run, &main, repeats_from) };
    let data_errors = crate::preprocess::checks::unit_mismatch::data_errors(run);
    Ok(Prepared { data_errors, warnings, ..Prepared::of(run, main, about) })
}

/// The chunks of all legs, of `n` samples each. A `raw` run keeps all of them.
fn layout<'a>(
    samples: &Source,
    run: &RunTable,
    inputs: &'a [Same],
    n: usize,
    raw: bool,
) -> Result<Layout<'a>, ModelError> {
    let legs = samples.legs();
    let conditions = conditions(samples, &legs, inputs);
    let thin = if raw { 1 } else { (run.len() / n).div_ceil(MOST_ROWS).max(1) };
    let (mut chunks, mut group, mut phase, mut condition) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (number, leg) in legs.iter().enumerate() {
        let leg = match run.kind() {
            Kind::Stiffness | Kind::Brake => samples.even_part(leg, n),
            _ => leg.clone(),
        };
        let held = match (run.kind(), samples.signals.find(Signal::Current)) {
            (Kind::Brake, Some(current)) => current_dwells::held(&current[leg.clone()], n),
            _ => Vec::new(),
        };
        // One chunk of several, not their mean, which would attenuate a short wave.
        for (k, start) in (leg.start..(leg.end + 1).saturating_sub(n)).step_by(n * thin).enumerate() {
            if held.get(k * thin) == Some(&false) {
                continue;
            }
            chunks.push(start..start + n);
            group.push(number);
            phase.push(k);
            condition.push(conditions[number]);
        }
    }
    if chunks.len() < 12 {
        return Err(ModelError::TooFewSamples { usable: chunks.len(), needed: 12, what: "chunks" });
    }
    Ok(Layout { chunks, group, condition, phase: Some(phase), settled: false, inputs })
}

/// A loading history before the run, in a sentence.
fn past(main: &mut Problem, kind: Kind) -> Option<String> {
    let (signal, message) = match kind {
        Kind::Brake => (
            Signal::Current,
            "the brake still remembered an earlier current when the run began, which is taken into account; demagnetise it \
             before a run, by loops that become smaller and smaller while it turns",
        ),
        Kind::Stiffness => (
            Signal::Load,
            "the joint still remembered an earlier torque when the run began, which is taken into account; load it once to \
             both sides before a run, or let the torque die down in swings that become smaller and smaller",
        ),
        Kind::Friction | Kind::Encoder => return None,
    };
    initial_hysteresis_state::find(main, signal).then(|| message.into())
}

/// Legs with the same start and end values are repeats of one condition.
fn conditions(samples: &Source, legs: &[Range<usize>], inputs: &[Same]) -> Vec<usize> {
    let mut keys: Vec<Vec<usize>> = vec![Vec::new(); legs.len()];
    for same in inputs {
        let Some(values) = samples.signals.find(same.signal()) else { continue };
        let values = same.of(values);
        let peak = peak(&values);
        let early = |leg: &Range<usize>| leg.start + leg.len() / 4..leg.start + leg.len() / 2;
        let late = |leg: &Range<usize>| leg.end - leg.len() / 4..leg.end;
        for part in [early as fn(&Range<usize>) -> Range<usize>, late] {
            let means: Vec<f64> = legs
                .iter()
                .map(|leg| {
                    let range = part(leg);
                    values[range.clone()].iter().sum::<f64>() / range.len().max(1) as f64
                })
                .collect();
            let cluster = blocks::clusters(&means, |v| SAME_LEVEL * v.abs() + SMALL_LEVEL * peak);
            keys.iter_mut().zip(cluster).for_each(|(k, c)| k.push(c));
        }
    }
    let mut known = keys.clone();
    known.sort();
    known.dedup();
    keys.iter().map(|k| known.binary_search(k).unwrap_or(0)).collect()
}

/// The torque as explained by the current and its history, which speed and temperature may scale as a whole.
pub fn brake_torque_of_current(problem: &Problem) -> Vec<f64> {
    let view = &problem.view;
    let current = view.samples.find(Signal::Current).unwrap_or_default();
    let peak = view.peak(Signal::Current);
    let mut columns: Vec<Vec<f64>> = (0..=3).map(|k| view.map(Signal::Current, |i| (i / peak).powi(k))).collect();
    columns.extend(
        (1..=8).map(|k| view.average(hysteresis_operators::stop(current, peak * f64::from(k) / 8.0, &view.starts))),
    );
    let rest = Basis::of(&columns).rest(&problem.target);
    problem.target.iter().zip(rest).map(|(y, e)| y - e).collect()
}
