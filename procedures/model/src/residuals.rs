//! The residual of a fit at every point, with all quantities that it may depend on.

use crate::prediction::{predict, prepare_alike};
use crate::preprocess::independent_blocks::independent_blocks;
use crate::preprocess::{Prepared, Problem};
use crate::report::fit::Fit;
use crate::report::residuals::{Axis, ResidualSet};
use crate::signal::Signal;
use crate::{ModelError, Options};
use jointbench_instrument::RunTable;

/// Measured and predicted values, with axes for plots. Points of ramps and reversals come last and are marked as not
/// fitted.
///
/// The run is preprocessed as for the fit. Callers may pass the `options` that they use for all calls; only their
/// limits are checked.
pub fn residuals(run: &RunTable, fit: &Fit, options: &Options) -> Result<ResidualSet, ModelError> {
    options.check()?;
    let prepared = prepare_alike(fit, run)?;
    let mut set = ResidualSet {
        residual: prepared.about.residual,
        unit: prepared.unit(),
        axes: axes(&prepared),
        measured: Vec::new(),
        predicted: Vec::new(),
        error: Vec::new(),
        held_out: Vec::new(),
        segment: Vec::new(),
        repeat: Vec::new(),
        piece: Vec::new(),
    };
    append(&mut set, &prepared, prepared.judged(&fit.effects), fit, false)?;
    if let Some(moving) = &prepared.moving {
        append(&mut set, &prepared, moving, fit, true)?;
    }
    Ok(set)
}

fn axes(prepared: &Prepared) -> Vec<Axis> {
    let axis = |name: &str, unit| Axis { name: name.into(), unit, values: Vec::new() };
    shown(prepared).map(|s| axis(prepared.column_name(s), prepared.column_unit(s))).collect()
}

/// Signals of the run, the most important ones first.
fn shown(prepared: &Prepared) -> impl Iterator<Item = Signal> {
    [
        Signal::Velocity,
        Signal::Link,
        Signal::Position,
        Signal::Load,
        Signal::Current,
        Signal::Temperature,
        Signal::Time,
        Signal::Direction,
        Signal::Acceleration,
        Signal::Repeat,
    ]
    .into_iter()
    .filter(|s| prepared.main.view.find(*s).is_some())
    .chain(prepared.main.view.points.unknown())
}

fn append(
    set: &mut ResidualSet,
    prepared: &Prepared,
    problem: &Problem,
    fit: &Fit,
    held_out: bool,
) -> Result<(), ModelError> {
    let predicted = predict(fit, problem)?;
    for (axis, signal) in set.axes.iter_mut().zip(shown(prepared)) {
        let (values, scale) = (problem.view.get(signal), prepared.column_scale(signal));
        let values = problem.reduce.apply(values.to_vec());
        axis.values.extend(values.into_iter().map(|v| v * scale));
    }
    set.error.extend(problem.target.iter().zip(&predicted).map(|(y, p)| y - p));
    set.measured.extend_from_slice(&problem.target);
    set.predicted.extend(predicted);
    set.held_out.extend(std::iter::repeat_n(held_out, problem.rows()));
    set.segment.extend_from_slice(&problem.segment);
    set.repeat.extend_from_slice(&problem.repeat);
    let next = set.piece.last().map_or(0, |last| last + 1);
    set.piece.extend(independent_blocks(problem, 1).0.into_iter().map(|piece| next + piece));
    Ok(())
}
