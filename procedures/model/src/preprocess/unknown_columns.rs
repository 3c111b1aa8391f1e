//! Unknown columns: axes of residual maps, and signals of user formulas.

use crate::signal::{Signal, Signals};
use jointbench_instrument::RunTable;

/// Keeps the columns of a run that no model uses.
pub fn keep(signals: &mut Signals, run: &RunTable) {
    let kind = run.kind();
    let is_known =
        |name: &str| kind.required_columns().iter().chain(kind.optional_columns()).any(|known| *known == name);
    for channel in run.trace().channels().iter().filter(|channel| !is_known(&channel.name)) {
        let values = run.column(&channel.name).filter(|values| values.iter().all(|v| v.is_finite()));
        if let Some(values) = values {
            signals.set(Signal::named(&channel.name), values.to_vec());
        }
    }
}
