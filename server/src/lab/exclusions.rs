//! Sections of a measurement that a person excludes from a fit.

use super::{Answer, LabError, names};
use crate::view::Exclusion;
use jointbench_instrument::{RunTable, Trace};

/// One brush along an axis of a long run creates fewer sections; a larger number is a mistake.
const MOST: usize = 5_000;

/// Refuses invalid sections.
pub fn check(stretches: &[Exclusion]) -> Answer<()> {
    if stretches.len() > MOST {
        return Err(LabError::Invalid(format!("{} excluded intervals: the maximum is {MOST}", stretches.len())));
    }
    for Exclusion { from_s, to_s, reason } in stretches {
        if !(from_s.is_finite() && to_s.is_finite() && from_s <= to_s) {
            return Err(LabError::Invalid(format!(
                "excluded interval from_s = {from_s}, to_s = {to_s}: from_s must be below to_s, in seconds since the \
                 first sample"
            )));
        }
        if reason.trim().is_empty() {
            return Err(LabError::Invalid(format!(
                "the excluded interval from {from_s} s to {to_s} s has no reason: enter one"
            )));
        }
        names::checked_text("the reason of an excluded interval", reason, names::LONGEST_SENTENCE)?;
    }
    Ok(())
}

/// For each time, counted from the first, whether it is excluded. The times are in ascending order.
pub fn marked(time_s: &[f64], stretches: &[Exclusion]) -> Vec<bool> {
    let mut sorted: Vec<(f64, f64)> = stretches.iter().map(|one| (one.from_s, one.to_s)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    // The largest end so far: the section that began last need not be the one that ends last.
    let mut furthest = f64::NEG_INFINITY;
    let ends: Vec<f64> = sorted
        .iter()
        .map(|(_, to_s)| {
            furthest = furthest.max(*to_s);
            furthest
        })
        .collect();
    let inside = |at_s: f64| match sorted.partition_point(|(from_s, _)| *from_s <= at_s) {
        0 => false,
        begun => at_s <= ends[begun - 1],
    };
    time_s.iter().map(|at_s| inside(*at_s)).collect()
}

/// The measurement without these sections, as if they had not been recorded.
pub fn without(table: RunTable, stretches: &[Exclusion]) -> Answer<RunTable> {
    if stretches.is_empty() {
        return Ok(table);
    }
    let (meta, trace) = table.into_parts();
    let time_s = trace.column("time_s").unwrap_or_default();
    let begin_s = time_s.first().copied().unwrap_or_default();
    let since: Vec<f64> = time_s.iter().map(|at_s| at_s - begin_s).collect();
    let out = marked(&since, stretches);
    if out.iter().all(|out| *out) {
        return Err(LabError::Invalid("all samples are excluded: keep some for the fit".into()));
    }
    let kept = |column: &Vec<f64>| column.iter().zip(&out).filter(|(_, out)| !**out).map(|(value, _)| *value).collect();
    let columns = trace.columns().iter().map(kept).collect();
    Ok(RunTable::new(meta, Trace::from_columns(trace.channels().to_vec(), columns))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stretch(from_s: f64, to_s: f64) -> Exclusion {
        Exclusion { from_s, to_s, reason: "cable touched".into() }
    }

    #[test]
    fn stretches_may_overlap_and_come_in_any_order() {
        let stretches = [stretch(5.0, 6.0), stretch(1.0, 4.0), stretch(2.0, 2.5)];
        let marks = marked(&[0.0, 1.0, 3.0, 4.5, 5.5, 6.0, 7.0], &stretches);
        assert_eq!(marks, [false, true, true, false, true, true, false]);
        assert_eq!(marked(&[0.0, 1.0], &[]), [false, false]);
    }

    #[test]
    fn what_cannot_be_meant_is_refused() {
        assert!(check(&[stretch(1.0, 2.0)]).is_ok());
        assert!(check(&[stretch(2.0, 1.0)]).is_err());
        assert!(check(&[stretch(f64::NAN, 1.0)]).is_err());
        assert!(check(&[Exclusion { reason: "  ".into(), ..stretch(1.0, 2.0) }]).is_err());
    }
}
