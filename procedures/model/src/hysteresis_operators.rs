//! Hysteresis operators: exact for a signal that is linear between samples, so that they are stable for any step
//! size.

use crate::view::Start;

/// Dahl: dz = (1 − z·sgn dx)·dx/reach, from its loading history at every start. The distance to ±1 decays
/// exponentially.
pub fn dahl(x: &[f64], reach: f64, starts: &[Start]) -> Vec<f64> {
    remember(x, starts, |_, z, step| {
        let end = if step < 0.0 { -1.0 } else { 1.0 };
        end + (z - end) * (-step.abs() / reach).exp()
    })
}

/// Stop operator, an elastic element that slips at ±1: dz = dx/reach within ±1, from its loading history at every
/// start.
pub fn stop(x: &[f64], reach: f64, starts: &[Start]) -> Vec<f64> {
    remember(x, starts, |_, z, step| (z + step / reach).clamp(-1.0, 1.0))
}

/// Elements of a Maxwell slip.
pub const MAXWELL_ELEMENTS: usize = 4;

/// Generalised Maxwell slip with elements of equal strength and reaches evenly spaced up to `reach`: a stop with
/// gradual slip. One more free parameter would hardly be identified by reversals.
pub fn maxwell_slip(x: &[f64], reach: f64, starts: &[Start]) -> Vec<f64> {
    const ELEMENTS: usize = MAXWELL_ELEMENTS;
    let mut sum = vec![0.0; x.len()];
    for k in 1..=ELEMENTS {
        let element = stop(x, reach * k as f64 / ELEMENTS as f64, starts);
        sum.iter_mut().zip(element).for_each(|(s, z)| *s += z / ELEMENTS as f64);
    }
    sum
}

/// LuGre without bristle damping: a Dahl state with the limits ±`strength`, which fall with speed according to the
/// Stribeck curve.
///
/// dz = (1 − z·sgn dx/strength)·dx/reach with the strength of each sample. The bristle damping acts only in the first
/// moment of a reversal, where instrument delays look the same.
pub fn lugre(x: &[f64], strength: &[f64], reach: f64, starts: &[Start]) -> Vec<f64> {
    remember(x, starts, |i, z, step| {
        let end = if step < 0.0 { -strength[i] } else { strength[i] };
        end + (z - end) * (-step.abs() / (reach * strength[i])).exp()
    })
}

/// First-order lag; `share` is the sample step divided by the time constant. Starts at its steady state.
pub fn lag(x: &[f64], share: f64, starts: &[Start]) -> Vec<f64> {
    let keep = (-share).exp();
    let mut state = 0.0;
    x.iter()
        .enumerate()
        .map(|(i, x)| {
            state = if starts.iter().any(|s| s.at == i) { *x } else { x + (state - x) * keep };
            state
        })
        .collect()
}

/// Whether the signal reverses by more than `depth`; only then is a hysteresis visible.
pub fn turns(x: &[f64], depth: f64) -> bool {
    let (mut high, mut low) = (f64::NEG_INFINITY, f64::INFINITY);
    let (mut fell, mut rose) = (false, false);
    for v in x {
        high = high.max(*v);
        low = low.min(*v);
        if high - v > depth {
            fell = true;
            (high, low) = (*v, low.min(*v));
        }
        if v - low > depth {
            rose = true;
            (low, high) = (*v, high.max(*v));
        }
    }
    fell && rose
}

/// The states from zero at every start, or after the loading history of the start.
fn remember(x: &[f64], starts: &[Start], next: impl Fn(usize, f64, f64) -> f64) -> Vec<f64> {
    let mut state = 0.0;
    let mut last = x.first().copied().unwrap_or_default();
    let mut starts = starts.iter().peekable();
    x.iter()
        .enumerate()
        .map(|(i, x)| {
            state = match starts.next_if(|s| s.at == i) {
                Some(Start { past: Some(past), .. }) => next(i, next(i, 0.0, *past), x - past),
                Some(_) => 0.0,
                None => next(i, state, x - last),
            };
            last = *x;
            state
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dahl_step_does_not_depend_on_its_cutting() {
        let coarse = dahl(&[0.0, 1.0, -1.0], 0.5, &[0.into()]);
        let fine: Vec<f64> =
            (0..=100).map(|i| f64::from(i) / 100.0).chain((0..200).map(|i| 0.99 - f64::from(i) / 100.0)).collect();
        assert!((dahl(&fine, 0.5, &[0.into()])[300] - coarse[2]).abs() < 1e-12);
    }

    #[test]
    fn lugre_is_dahl_at_one_strength_and_ends_at_its_own_elsewhere() {
        let x: Vec<f64> = (0..400).map(|i| (f64::from(i) * 0.05).sin()).collect();
        assert_eq!(lugre(&x, &[1.0; 400], 0.2, &[0.into(), 150.into()]), dahl(&x, 0.2, &[0.into(), 150.into()]));
        let far: Vec<f64> = (0..50).map(f64::from).collect();
        assert!((lugre(&far, &[1.5; 50], 0.2, &[0.into()])[49] - 1.5).abs() < 1e-9);
    }

    #[test]
    fn maxwell_slip_yields_little_by_little_and_closes_its_loop() {
        let z = maxwell_slip(&[0.0, 0.5, 1.0, 2.0, -2.0, 2.0], 1.0, &[0.into()]);
        assert!(z[1] < z[2] && z[1] > 0.5, "softer than its first part, stiffer than its last: {z:?}");
        let ends = [z[3] - 1.0, z[4] + 1.0, z[5] - 1.0];
        assert!(ends.iter().all(|e| e.abs() < 1e-12), "{z:?}");
    }

    #[test]
    fn a_stop_slips_and_comes_back_at_once() {
        assert_eq!(stop(&[0.0, 3.0, 2.5, 0.0], 1.0, &[0.into()]), [0.0, 1.0, 0.5, -1.0]);
    }

    #[test]
    fn what_came_before_is_remembered_until_it_is_passed() {
        let x = [0.0, 0.5, 1.5, 2.0];
        let after = |past| stop(&x, 1.0, &[Start { at: 0, past: Some(past) }]);
        assert_eq!(after(0.4)[1..], stop(&x, 1.0, &[0.into()])[1..]);
        assert_eq!(after(1.5), [-0.5, 0.0, 1.0, 1.0]);
        assert_eq!(after(9.0), [-1.0, -0.5, 0.5, 1.0]);
    }

    #[test]
    fn one_branch_does_not_turn() {
        assert!(!turns(&[0.0, 0.5, 1.0], 0.1));
        assert!(turns(&[0.0, 1.0, 0.2, 1.0], 0.1));
        assert!(turns(&[1.0, 0.0, 1.0], 0.1));
    }
}
