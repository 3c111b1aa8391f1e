//! Error of a table with linear interpolation between its points.

use crate::ModelError;
use crate::export::table::Layout;
use crate::preprocess::Problem;
use crate::report::fit::Fit;
use crate::signal::Signals;
use rayon::prelude::*;
use std::ops::Range;

/// Number of steady-state samples for the mean of the table.
const INFORMATIVE_ROWS: usize = 16;

/// Interpolation error midway between neighbouring points: RMS and maximum. `None` without an axis.
pub fn between(layout: &Layout, values: &[f64]) -> Result<Option<[f64; 2]>, ModelError> {
    let (mut square, mut most, mut count) = (0.0, 0.0f64, 0usize);
    for along in 0..layout.axes.len() {
        let middles = layout.rows(|axis, place| match place == along {
            // The direction change itself is not interpolated.
            true => axis.points.windows(2).filter(|w| w[0] * w[1] >= 0.0).map(|w| 0.5 * (w[0] + w[1])).collect(),
            false => axis.points.clone(),
        });
        let truth = layout.predict(&middles)?;
        for (row, truth) in middles.iter().zip(truth) {
            let off = (layout.interpolate(values, |axis| row[axis]) - truth).abs();
            (square, most, count) = (square + off * off, most.max(off), count + 1);
        }
    }
    Ok((count > 0).then(|| [(square / count as f64).sqrt(), most]))
}

/// The error at the points of the fitted run. `None` if the run lacks an axis.
pub fn on_run(fit: &Fit, problem: &Problem) -> Result<Option<f64>, ModelError> {
    let layout = Layout::of(fit)?;
    let values = layout.predict(&layout.grid())?;
    let view = &problem.view;
    fn axes<'s>(layout: &Layout, signals: &'s Signals) -> Option<Vec<&'s [f64]>> {
        layout.axes.iter().map(|axis| signals.find(axis.signal.signal)).collect()
    }
    let at = |columns: &[&[f64]], i: usize| layout.interpolate(&values, |axis| columns[axis][i]);
    let column: Vec<f64> = match (axes(&layout, &view.samples), axes(&layout, &view.points)) {
        (Some(samples), _) if !view.chunks.is_empty() => {
            let mean = |c: &Range<usize>| {
                let each = c.clone().step_by(c.len().div_ceil(INFORMATIVE_ROWS));
                each.clone().map(|i| at(&samples, i)).sum::<f64>() / each.len() as f64
            };
            view.chunks.par_iter().map(mean).collect()
        }
        (_, Some(points)) => (0..view.len()).map(|i| at(&points, i)).collect(),
        _ => return Ok(None),
    };
    let predicted = problem.reduce.apply(column);
    let sse: f64 = problem.target.iter().zip(predicted).map(|(y, predicted)| (y - predicted).powi(2)).sum();
    Ok(Some((sse / problem.rows() as f64).sqrt()))
}
