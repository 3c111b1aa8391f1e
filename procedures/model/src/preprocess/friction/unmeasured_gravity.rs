//! Gravity torque of the link that no load sensor measures.

use crate::linear::basis::{Basis, dot};
use crate::signal::{Signal, Signals};
use crate::thresholds::{GRAVITY_OWN_SHARE, GRAVITY_SHARE};

/// Largest number of evaluated points.
const MOST: usize = 4000;

/// Gravity torque in addition to the measured load, if there is one, as coefficients of cos and sin of the link angle
/// [Nm]. The gear teeth carry it too if the sensor is mounted beyond the weight.
pub fn unmeasured(signals: &Signals, torque_nm: &[f64]) -> Option<[f64; 2]> {
    let every = torque_nm.len().div_ceil(MOST);
    let thin = |values: &[f64]| -> Vec<f64> { values.iter().step_by(every).copied().collect() };
    let load = signals.find(Signal::Load).map(thin);
    let link = thin(signals.find(Signal::Link)?);
    let direction = thin(signals.find(Signal::Direction)?);
    let mut columns = vec![vec![1.0; link.len()]];
    columns.extend([Signal::Velocity, Signal::Acceleration].into_iter().filter_map(|s| signals.find(s)).map(thin));
    if let Some(load) = load {
        columns.push(load.iter().zip(&direction).map(|(l, d)| l.abs() * d).collect());
        columns.push(load);
    }
    columns.push(direction);
    let mut basis = Basis::of(&columns);
    let waves: [Vec<f64>; 2] = [link.iter().map(|a| a.cos()).collect(), link.iter().map(|a| a.sin()).collect()];
    let left = basis.rest(&thin(torque_nm));
    let own = waves.each_ref().map(|wave| basis.push(wave));
    if own.iter().any(|share| *share < GRAVITY_OWN_SHARE) {
        return None;
    }
    let [.., c, s] = basis.vectors() else { return None };
    let along = [dot(c, &left), dot(s, &left)];
    if along.iter().map(|a| a * a).sum::<f64>() < GRAVITY_SHARE * dot(&left, &left) {
        return None;
    }
    // Converts basis coefficients to wave coefficients: the second basis vector contains a part of the first wave.
    let g_s = along[1] / dot(s, &waves[1]);
    Some([(along[0] - g_s * dot(c, &waves[1])) / dot(c, &waves[0]), g_s])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signals(weighs_in_load: bool) -> (Signals, Vec<f64>) {
        let n = 3000;
        let link: Vec<f64> = (0..n).map(|i| 2.0 * (f64::from(i) * 0.004).sin()).collect();
        let direction: Vec<f64> = (0..n).map(|i| (f64::from(i) * 0.004).cos().signum()).collect();
        let weight: Vec<f64> = link.iter().map(|a| 0.02 * a.cos() - 0.05 * a.sin()).collect();
        let load: Vec<f64> = (0..n as usize)
            .map(|i| if weighs_in_load { weight[i] } else { 0.1 * direction[i] * ((i / 500) as f64) })
            .collect();
        let all = |i: usize| if weighs_in_load { load[i] } else { load[i] + weight[i] };
        let torque = (0..n as usize).map(|i| all(i) + (0.03 + 0.1 * all(i).abs()) * direction[i]).collect();
        let mut signals = Signals::new(n as usize);
        signals.set(Signal::Link, link);
        signals.set(Signal::Direction, direction);
        signals.set(Signal::Load, load);
        (signals, torque)
    }

    #[test]
    fn a_weight_outside_of_the_load_is_found() {
        let (known, torque) = signals(false);
        let [c, s] = unmeasured(&known, &torque).unwrap();
        assert!((c - 0.02).abs() < 0.01 && (s + 0.05).abs() < 0.01, "{c} {s}");
        let (known, torque) = signals(true);
        assert_eq!(unmeasured(&known, &torque), None);
    }
}
