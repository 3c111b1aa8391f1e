//! The run determines the size of the candidate: its uncertainty is smaller than the measured signal.
//!
//! Where the candidate and its other forms are nearly collinear with the model, such as curves over the speed of a single
//! sine, they reduce the error together, but the candidate may have any size.

use crate::inference::block_intervals::Estimates;
use crate::selection::evidence_search::rules::Refit;
use crate::stats::summary::{deviation, rms};

pub(super) fn passes(refit: &Refit) -> bool {
    let model = &refit.after.main;
    let Some(estimates) = Estimates::of(model) else { return true };
    let signal = deviation(&model.response());
    let columns = model.terms.iter().flat_map(|term| term.columns.iter().map(move |column| (term.id(), column)));
    let mut uncertainties = columns.zip(estimates.half_widths()).filter(|((id, _), _)| *id == refit.id).peekable();
    uncertainties.peek().is_none() || uncertainties.any(|((_, column), half)| is_determined(half, column, signal))
}

fn is_determined(half_width: f64, column: &[f64], signal: f64) -> bool {
    half_width * rms(column) < signal
}

#[cfg(test)]
mod tests {
    use super::is_determined;

    #[test]
    fn an_effect_that_may_exceed_the_signal_has_no_determined_size() {
        let column = [0.5, -0.5, 0.5, -0.5];
        assert!(is_determined(0.3, &column, 0.2));
        assert!(!is_determined(0.5, &column, 0.2));
    }
}
