//! The structure that remains with the last model, in words.

use crate::Fit;
use crate::diagnosis::findings::Findings;
use crate::report::maps::PairMap;
use crate::residual_analysis::events::Events;
use crate::residual_analysis::lack_of_fit;
use crate::residual_analysis::structure::{MEANS_S, Pattern, Unexplained};
use crate::thresholds::{NOTHING_IN_COMMON, PRACTICAL_SHARE, SECOND_AXIS_GAIN};
use crate::words::{figure, list, percent, spoken_axis};

/// Where the residual is largest.
pub fn structure(found: &Findings, end: &Fit, shown: Option<&PairMap>) -> String {
    let error = figure(end.validation_rms, &end.unit);
    let repeatable = match found.floor.repeatable_share {
        Some(share) if share < NOTHING_IN_COMMON => Some(format!("less than {}", percent(NOTHING_IN_COMMON))),
        share => share.map(percent),
    };
    let repeats = repeatable.map(|share| format!("; of the squared error of repeated readings, {share} is repeatable"));
    let repeats = repeats.unwrap_or_default();
    if lack_of_fit::structured(&found.maps).is_none()
        && let Some(event) = found.events.first()
    {
        let [from_s, to_s] = Events::span_s(&found.start.prepared.main, event);
        // Without repeats no recurrence can be observed.
        let has_repeats = !found.start.prepared.main.replicate_pairs.is_empty();
        let and = |recurs: &'static str| if has_repeats { recurs } else { "" };
        let which = match found.events.len() {
            1 => format!(
                "one interval of the run deviates far beyond the scatter of all others{}:",
                and(" and does not recur")
            ),
            count => format!(
                "{count} intervals of the run deviate far beyond the scatter of all others{}; the largest:",
                and(" and do not recur")
            ),
        };
        return format!(
            "{which} {} from {from_s:.2} s to {to_s:.2} s (remaining error {error}{repeats})",
            figure(event.mean.abs(), &end.unit)
        );
    }
    if let Some(text) = found.decided.as_ref().and_then(|decided| over_time(decided.left.as_ref()?)) {
        return format!("{text} (now {error} RMS{repeats})");
    }
    match shown_over(found, shown) {
        Some((axes, share)) => format!(
            "it is largest over {}, and a function of that would remove {} of the remaining squared error (now {error} RMS{repeats})",
            list(&axes.iter().map(|axis| spoken_axis(axis, found.start.prepared.kind)).collect::<Vec<_>>()),
            percent(share),
        ),
        None => format!(
            "no function of one axis removes {} of the squared error (remaining error {error}{repeats})",
            percent(PRACTICAL_SHARE)
        ),
    }
}

/// Structure in time, which is no function of an axis.
fn over_time(left: &Unexplained) -> Option<String> {
    let share = percent(left.share);
    match &left.pattern {
        Pattern::Function(_) => None,
        Pattern::Wave(hz) => Some(format!("{share} of the squared residual is a wave of {}", figure(*hz, "Hz"))),
        Pattern::Correlation => Some(format!(
            "neighbouring means of the residual over {} are correlated, and their covariance is {share} of its variance: \
             something changes slowly, or a quantity was not recorded",
            figure(MEANS_S, "s")
        )),
    }
}

/// The columns with most structure, and the cross-validated R² of a function of them. `None` without such a function.
pub fn shown_over(found: &Findings, shown: Option<&PairMap>) -> Option<(Vec<String>, f64)> {
    if let Some(decided) = &found.decided {
        let prepared = found.start.prepared;
        let left = decided.left.as_ref()?;
        let Pattern::Function(signals) = &left.pattern else { return None };
        return Some((signals.iter().map(|signal| prepared.column_name(*signal).to_owned()).collect(), left.share));
    }
    let pair = shown.map(|s| (vec![s.x.clone(), s.y.clone()], s.removable_share));
    let axis = found.maps.shows_over();
    // A second axis divides the bins of the first one, so that a single axis can have a larger R², and is simpler to
    // report.
    let pair = pair.filter(|(_, both)| axis.as_ref().is_none_or(|(_, alone)| *both > SECOND_AXIS_GAIN * alone));
    let most = pair.or(axis);
    most.filter(|(_, share)| *share > PRACTICAL_SHARE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Signal;

    #[test]
    fn a_wave_and_slow_changes_are_no_functions_of_time() {
        let text = |pattern| over_time(&Unexplained { pattern, share: 0.34, is_all: false });
        assert_eq!(text(Pattern::Function(vec![Signal::Velocity])), None);
        assert_eq!(text(Pattern::Wave(0.7)).as_deref(), Some("34 % of the squared residual is a wave of 0.70 Hz"));
        let slow = text(Pattern::Correlation).unwrap_or_default();
        assert!(slow.starts_with("neighbouring means of the residual over 0.50 s are correlated"), "{slow}");
    }
}
