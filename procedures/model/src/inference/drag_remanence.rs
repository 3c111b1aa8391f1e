//! The drag torque of a brake and its remanence are confounded: a brake at rest after a fall of its current holds
//! both, and the model assigns all of it to the drag.

use crate::effects::brake::{drag, hysteresis};
use crate::regression::linear_model::LinearModel;
use crate::report::fit::Parameter;
use crate::signal::{Signal, Signals};
use crate::stats::summary::mean;
use crate::thresholds::NO_CURRENT;
use crate::view::View;
use crate::words::figure;

/// Extends the interval of the drag to the torque of a demagnetised brake: measured before the first current, or
/// predicted by the hysteresis effect.
pub fn open(terms: &LinearModel, parameters: &mut [Parameter]) {
    let Some(hysteresis) = terms.terms.iter().position(|t| t.id() == hysteresis::ID) else { return };
    let Some(drag) = parameters.iter_mut().find(|p| p.effect == drag::ID) else { return };
    let fresh = fresh(terms);
    // Demagnetised, it holds no more than after a current.
    let most = without_current(terms).unwrap_or(f64::INFINITY);
    let empty = fresh.unwrap_or_else(|| {
        let term = &terms.terms[hysteresis];
        let whole = term.effect.columns(term.form.name, &term.shape, &demagnetised());
        let coefficients = &terms.linear().coefficients[hysteresis];
        drag.value + whole.iter().zip(coefficients).map(|(column, coefficient)| column[0] * coefficient).sum::<f64>()
    });
    let empty = empty.min(most);
    let empty = empty.max(0.0);
    if (drag.ci95[0]..=drag.ci95[1]).contains(&empty) {
        return;
    }
    drag.ci95 = [drag.ci95[0].min(empty), drag.ci95[1].max(empty)];
    let empty = figure(empty, &drag.unit);
    drag.note = Some(match fresh {
        Some(_) => {
            format!("includes the remanence after the largest current: before any current the brake held {empty}")
        }
        None => format!(
            "trades off with hysteresis, because it includes the remanence after the largest current: demagnetised, the brake would hold {empty}; begin a run without current after demagnetising it"
        ),
    });
}

/// Mean torque of all rows without current.
fn without_current(terms: &LinearModel) -> Option<f64> {
    let view = &terms.problem.view;
    let none = NO_CURRENT * view.peak(Signal::Current);
    let rows = view.get(Signal::Current).iter().zip(&terms.problem.target).filter(|(current, _)| current.abs() < none);
    let held: Vec<f64> = rows.map(|(_, torque)| *torque).collect();
    (!held.is_empty()).then(|| mean(&held))
}

/// Torque before the first current of a recording that starts demagnetised.
fn fresh(terms: &LinearModel) -> Option<f64> {
    let view = &terms.problem.view;
    let current = view.get(Signal::Current);
    let none = NO_CURRENT * view.peak(Signal::Current);
    let starts = view.starts.iter().filter(|start| start.past.is_none());
    let rows = starts.flat_map(|start| {
        let first = view.chunks.partition_point(|chunk| chunk.start < start.at);
        (first..current.len()).take_while(|row| current[*row].abs() < none)
    });
    let held: Vec<f64> = rows.map(|row| terms.problem.target[row]).collect();
    (!held.is_empty()).then(|| mean(&held))
}

/// A single sample without current and without loading history.
fn demagnetised() -> View {
    let mut none = Signals::new(1);
    none.set(Signal::Current, vec![0.0]);
    View::new(none.clone(), none, Vec::new(), vec![0], 1.0)
}
