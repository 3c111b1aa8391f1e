//! Unknown columns: axes of residual maps, and signals of user formulas.

use crate::preprocess::LARGEST;
use crate::signal::{Signal, Signals};
use jointbench_instrument::{Kind, RunTable};

/// Whether models of a kind use this column.
pub fn is_known(kind: Kind, name: &str) -> bool {
    kind.required_columns().iter().chain(kind.optional_columns()).any(|known| *known == name)
}

/// Keeps the columns of a run that no model uses, if all their values can be computed with.
pub fn keep(signals: &mut Signals, run: &RunTable) {
    let kind = run.kind();
    for channel in run.trace().channels().iter().filter(|channel| !is_known(kind, &channel.name)) {
        let values = run.column(&channel.name).filter(|values| values.iter().all(|v| v.abs() <= LARGEST));
        if let Some(values) = values {
            signals.set(Signal::named(&channel.name), values.to_vec());
        }
    }
}
