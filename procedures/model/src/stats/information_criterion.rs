//! Bayesian information criterion (Schwarz 1978).

/// Whether a fit with `more` additional parameters (negative: fewer) and the squared error `sse` is better than one with
/// the squared error `than`.
pub fn is_better(sse: f64, than: f64, more: f64, rows: usize) -> bool {
    let rows = rows as f64;
    rows * (sse / than).ln() + more * rows.ln() < 0.0
}

#[cfg(test)]
mod tests {
    use super::is_better;

    #[test]
    fn a_parameter_more_has_to_explain_more_than_noise() {
        // ln(1000) / 1000 = 0.7 %.
        assert!(is_better(0.992, 1.0, 1.0, 1000) && !is_better(0.994, 1.0, 1.0, 1000));
        assert!(is_better(1.006, 1.0, -1.0, 1000) && !is_better(1.008, 1.0, -1.0, 1000));
        assert!(!is_better(0.0, 0.0, 1.0, 1000));
    }
}
