//! What it means for its user that another instrument answers.

use crate::config::BenchDescription;
use jointbench_instrument::Fault;

/// The fault of the instrument in this role, for people: which calibration does not hold for another one, and what to do.
pub(super) fn told(fault: &Fault, role: &str, description: &BenchDescription) -> String {
    if !fault.is_wrong_instrument() {
        return fault.to_string();
    }
    let day = description.calibrated.iter().find(|(known, _)| known == role);
    let calibration =
        day.map(|(_, day)| format!(" `calibrated = {day}` is of the expected one and does not hold for it."));
    let calibration = calibration.unwrap_or_default();
    format!(
        "{fault}.{calibration} Put the expected one back and retry, or describe the other one in the bench's file and start \
         the daemon again"
    )
}
