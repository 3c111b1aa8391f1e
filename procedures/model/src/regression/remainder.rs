//! What the effects of a model cannot represent of a nuisance column.

use crate::linear::blocked_ridge::BaseColumn;
use crate::linear::cholesky::projections;
use crate::stats::summary::rms;

/// A column of another form without the part that the effects of the model can represent.
///
/// That part counts as size of the effects (restricted regression, Hodges, Reich 2010). The fitted sum is the same as
/// with the whole column, because the ridge penalty refers to the whole column and not to the effects.
pub struct Remainder {
    pub values: Vec<f64>,
    /// RMS of the whole column.
    pub scale: f64,
    /// Coefficients of the effects' columns in the whole column.
    pub parts: Vec<f64>,
}

impl Remainder {
    /// `effects`: the columns of the model; `None` for one that receives no part.
    pub fn of(whole: &Vec<f64>, effects: &[Option<&Vec<f64>>]) -> Self {
        let receivers: Vec<&Vec<f64>> = effects.iter().copied().flatten().collect();
        let found = projections(std::slice::from_ref(whole), &receivers).remove(0);
        let mut values = whole.clone();
        for (effect, part) in receivers.iter().zip(&found) {
            values.iter_mut().zip(*effect).for_each(|(v, e)| *v -= part * e);
        }
        let mut found = found.into_iter();
        let parts = effects.iter().map(|effect| effect.and_then(|_| found.next()).unwrap_or(0.0)).collect();
        Self { values, scale: rms(whole), parts }
    }

    pub fn column(&self) -> BaseColumn<'_> {
        BaseColumn { values: &self.values, scale: self.scale, is_penalised: true }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::basis::dot;

    #[test]
    fn the_difference_of_two_curves_is_mostly_size_of_the_effects() {
        let over = |f: fn(f64) -> f64| -> Vec<f64> { (1..=40).map(|i| f(0.1 * f64::from(i))).collect() };
        let effects = [over(|_| 1.0), over(|w| w), over(|w| w / (w + 1.0))];
        let whole = over(|w| w / (w + 2.0));
        let acceleration = over(f64::cos);
        let [constant, line, curve] = effects.each_ref().map(Some);
        let remainder = Remainder::of(&whole, &[constant, line, None, curve]);
        assert_eq!(remainder.parts[2], 0.0);
        let effects = [&effects[0], &effects[1], &acceleration, &effects[2]];
        assert!([0, 1, 3].iter().all(|k| dot(effects[*k], &remainder.values).abs() < 1e-9));
        assert!(rms(&remainder.values) < 0.02 * remainder.scale, "{}", rms(&remainder.values));
        // The whole column is the sum of both.
        for (at, value) in remainder.values.iter().enumerate() {
            let part: f64 = effects.iter().zip(&remainder.parts).map(|(effect, part)| part * effect[at]).sum();
            assert!((value + part - whole[at]).abs() < 1e-9);
        }
    }
}
