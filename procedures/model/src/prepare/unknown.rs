//! Columns that the models do not know: axes over which what they leave may show, and signals of users' formulas.

use crate::view::{Signal, Signals};
use jointbench_instrument::RunTable;
use jointbench_instrument::units::unit_of;

/// What is told in these units follows from the torque and does not cause it, is motion, which known columns tell, or a
/// clock. Over the drive's own effort every scatter of the torque shows.
const NO_CAUSE: [&str; 9] = ["Nm", "A", "V", "W", "rad", "rad/s", "rad/s²", "s", "ms"];

/// Where a stage stood: set from outside, and no motion of the joint.
pub fn is_pose(column: &str) -> bool {
    column.starts_with("stage_")
}

/// What is left may depend on a column of this name. Not on one without a unit: it may be the response under another
/// name.
pub fn may_cause(column: &str) -> bool {
    is_pose(column) || unit_of(column).is_some_and(|unit| !NO_CAUSE.contains(&unit))
}

/// Keeps the columns of a run that nobody knows.
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
