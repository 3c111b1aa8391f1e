//! States that remember: exact for a signal that moves in straight steps, so they are stable at any step.

/// Dahl: dz = (1 − z·sgn dx)·dx/reach, from 0 at every start. What is left to ±1 shrinks exponentially.
pub fn dahl(x: &[f64], reach: f64, starts: &[usize]) -> Vec<f64> {
    remember(x, starts, 0.0, |z, step| {
        let end = if step < 0.0 { -1.0 } else { 1.0 };
        end + (z - end) * (-step.abs() / reach).exp()
    })
}

/// An elastic element that slips at ±1: dz = dx/reach within ±1, from 0 at every start.
pub fn stop(x: &[f64], reach: f64, starts: &[usize]) -> Vec<f64> {
    remember(x, starts, 0.0, |z, step| (z + step / reach).clamp(-1.0, 1.0))
}

/// First-order lag; `share` is the sample step by the time constant. Starts settled.
pub fn lag(x: &[f64], share: f64, starts: &[usize]) -> Vec<f64> {
    let keep = (-share).exp();
    let mut state = 0.0;
    x.iter()
        .enumerate()
        .map(|(i, x)| {
            state = if starts.contains(&i) { *x } else { x + (state - x) * keep };
            state
        })
        .collect()
}

/// The signal comes back by more than `depth` after it has gone: only then has a memory something to show.
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

fn remember(x: &[f64], starts: &[usize], rest: f64, next: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let mut state = rest;
    let mut last = x.first().copied().unwrap_or_default();
    let mut starts = starts.iter().peekable();
    x.iter()
        .enumerate()
        .map(|(i, x)| {
            state = if starts.next_if(|s| **s == i).is_some() { rest } else { next(state, x - last) };
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
        let coarse = dahl(&[0.0, 1.0, -1.0], 0.5, &[0]);
        let fine: Vec<f64> =
            (0..=100).map(|i| f64::from(i) / 100.0).chain((0..200).map(|i| 0.99 - f64::from(i) / 100.0)).collect();
        assert!((dahl(&fine, 0.5, &[0])[300] - coarse[2]).abs() < 1e-12);
    }

    #[test]
    fn a_stop_slips_and_comes_back_at_once() {
        assert_eq!(stop(&[0.0, 3.0, 2.5, 0.0], 1.0, &[0]), [0.0, 1.0, 0.5, -1.0]);
    }

    #[test]
    fn one_branch_does_not_turn() {
        assert!(!turns(&[0.0, 0.5, 1.0], 0.1));
        assert!(turns(&[0.0, 1.0, 0.2, 1.0], 0.1));
        assert!(turns(&[1.0, 0.0, 1.0], 0.1));
    }
}
