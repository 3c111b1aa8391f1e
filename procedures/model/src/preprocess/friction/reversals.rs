//! Rests and reversals of a trajectory: there friction is no sign of the speed.
//!
//! A joint that sticks holds whatever the torque asks for, and the sign turns between two samples: filters carry both over their
//! own length. Only contacts that bend before they slip show there.

use crate::effects;
use crate::linear::basis::{Basis, dot};
use crate::preprocess::chunks::Source;
use crate::preprocess::filter::{LowPass, by_recording};
use crate::preprocess::{Reduce, median};
use crate::signal::Signal;
use crate::thresholds::{HYSTERESIS_SHARE, HYSTERESIS_SWING, REST_SPEED};
use crate::view::View;
use jointbench_instrument::Kind;

/// Samples of a rest or a reversal, with those `reach` samples beside them. `None` where the slope of a position passes through
/// most reversals within less than that: it is smoothed as the torque is.
pub fn near(samples: &Source, reach: usize) -> Option<Vec<bool>> {
    let of = |signal| samples.signals.find(signal).unwrap_or_default();
    let (velocity, direction) = (of(Signal::Velocity), of(Signal::Direction));
    let smooth = LowPass::butterworth(4, 2.0 * samples.cutoff_hz * samples.step_s);
    let smooth = by_recording(velocity, &samples.starts, |_, v| smooth.both_ways(v, 12));
    let noise = median(velocity.iter().zip(&smooth).map(|(a, b)| (a - b).abs()));
    let fastest = smooth.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let least = if samples.derived_velocity { REST_SPEED * fastest } else { 0.0 };
    let slow = (2.0 * noise).min(0.02 * fastest).max(least);
    let rests = |range: &mut dyn Iterator<Item = usize>| range.take_while(|i| smooth[*i].abs() < slow).count();
    let turns = (1..velocity.len()).filter(|i| direction[*i] != direction[i - 1]);
    let longs = turns.map(|i| rests(&mut (0..i).rev()) + rests(&mut (i..velocity.len())));
    if samples.derived_velocity && 2.0 * median(longs.map(|n| n as f64)) < reach as f64 {
        return None;
    }
    let mut near = vec![false; velocity.len()];
    let mut done = 0;
    for i in 1..velocity.len() {
        if smooth[i].abs() < slow || direction[i] != direction[i - 1] {
            let end = (i + reach + 1).min(near.len());
            near[done.max(i.saturating_sub(reach))..end].fill(true);
            done = end;
        }
    }
    Some(near)
}

/// Whether the contacts bend there before they slip, over more than the shortest way that could be seen.
pub fn bend(view: &View, target: &[f64], reduce: &Reduce, near: &[f64]) -> bool {
    let Ok(presliding) = effects::find(Kind::Friction, "presliding") else { return false };
    let beside = [Signal::Velocity, Signal::Acceleration, Signal::Jerk, Signal::Load];
    let mut columns: Vec<Vec<f64>> = beside.iter().filter_map(|s| view.find(*s)).map(<[f64]>::to_vec).collect();
    columns.extend([vec![1.0; target.len()], view.get(Signal::Direction).to_vec(), target.to_vec()]);
    let mut columns = reduce.apply_all(columns);
    let (Some(torque), Some(sign)) = (columns.pop(), columns.pop()) else { return false };
    let factor = |of: &[f64]| dot(of, &torque) / dot(of, of).max(f64::MIN_POSITIVE);
    let dry_nm = factor(&Basis::of(&columns).rest(&sign));
    columns.push(sign);
    let basis = Basis::of(&columns);
    let rest = basis.rest(&torque);
    let there = |rest: &mut dyn Iterator<Item = f64>| -> f64 { rest.zip(near).map(|(e, near)| near * e * e).sum() };
    let energy = there(&mut rest.iter().copied());
    presliding.forms(view).iter().any(|form| {
        let tried = form.grid.iter().enumerate().map(|(at, shape)| {
            let late = basis.rest(&reduce.apply(presliding.columns(form.name, shape, view).remove(0)));
            let late_nm = factor(&late);
            let left = there(&mut rest.iter().zip(&late).map(|(e, z)| e - late_nm * z));
            (at, late_nm, left)
        });
        let best = tried.min_by(|a, b| a.2.total_cmp(&b.2));
        best.is_some_and(|(at, late_nm, left)| {
            at > 0 && late_nm > HYSTERESIS_SWING * dry_nm && left < (1.0 - HYSTERESIS_SHARE) * energy
        })
    })
}
