//! The library of effects, one file for each effect.

pub(crate) mod brake;
pub(crate) mod encoder;
pub(crate) mod friction;
mod linear;
pub(crate) mod stiffness;

pub use crate::effects::friction::teeth::{ONLY_WEIGHT, WITH_WEIGHT};

use crate::ModelError;
use crate::effect::{Effect, Form, Regime, Shape, ShapeSearch};
use crate::signal::Signal;
use crate::thresholds::{FOLLOWED_ROWS, PERIODS_SEEN, WHOLE_TURN};
use crate::view::View;
use jointbench_instrument::Kind;
use std::ops::RangeInclusive;

/// All effects of a kind, in the order of the library.
pub fn effects(kind: Kind) -> &'static [&'static dyn Effect] {
    match kind {
        Kind::Friction => friction::ALL,
        Kind::Encoder => encoder::ALL,
        Kind::Stiffness => stiffness::ALL,
        Kind::Brake => brake::ALL,
    }
}

/// The effect with an id. [`ModelError::UnknownEffect`] lists the known ids.
pub fn find(kind: Kind, id: &str) -> Result<&'static dyn Effect, ModelError> {
    effects(kind).iter().copied().find(|e| e.info().id == id).ok_or_else(|| ModelError::UnknownEffect {
        id: id.to_owned(),
        kind,
        known: effects(kind).iter().map(|e| e.info().id.to_owned()).collect(),
    })
}

/// Whether an effect changes the direction of friction in a run that is judged sample by sample.
pub(crate) fn changes_direction(id: &str) -> bool {
    find(Kind::Friction, id).is_ok_and(|effect| effect.traits().changes_direction)
}

/// `count` values from `low` to `high` with a constant ratio.
pub(crate) fn log_grid(low: f64, high: f64, count: usize) -> Vec<f64> {
    let ratio = (high / low).ln();
    (0..count).map(|i| low * (ratio * i as f64 / (count - 1).max(1) as f64).exp()).collect()
}

/// Slow and fast ends of the motion [rad/s]: the 2nd and the 98th percentile of |ω|. `None` without motion.
fn speed_range(view: &View) -> Option<(f64, f64)> {
    magnitudes(view, Signal::Velocity)
}

/// Range of the magnitudes of a signal without outliers, at most a factor of 1000. `None` for a signal that is zero.
fn magnitudes(view: &View, signal: Signal) -> Option<(f64, f64)> {
    let mut sizes = view.map(signal, f64::abs);
    sizes.sort_by(f64::total_cmp);
    let at = |share: f64| sizes.get((share * sizes.len().saturating_sub(1) as f64) as usize).copied();
    let (low, high) = (at(0.02)?, at(0.98)?);
    (high > 0.0).then(|| (low.max(1e-3 * high), high))
}

/// Range of reaches that reversals can identify: from a thousandth of the motion between two reversals, or three
/// encoder steps, to the 90th percentile of these motions. `None` without reversals.
fn reversal_range(view: &View) -> Option<(f64, f64)> {
    if view.constants.followed_hz.is_some() {
        return view.constants.reaches.map(|[low, high]| (low, high)).filter(|(low, high)| low < high);
    }
    let position = view.samples.find(Signal::Position)?;
    let direction = view.samples.find(Signal::Direction)?;
    let mut turns = vec![position[0]];
    let mut last = direction[0];
    for (q, d) in position.iter().zip(direction) {
        if *d != 0.0 && *d != last {
            turns.push(*q);
            last = *d;
        }
    }
    let mut ways: Vec<f64> = turns.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|w| *w > 0.0).collect();
    ways.sort_by(f64::total_cmp);
    let typical = *ways.get(ways.len() / 2)?;
    // A reach below the encoder's step is a jump.
    let mut steps: Vec<f64> = position.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|s| *s > 0.0).collect();
    let smallest = steps.iter().copied().fold(f64::INFINITY, f64::min);
    steps.retain(|s| *s < 1.5 * smallest);
    let counted = steps.len() * 20 > position.len();
    let low = if counted { (3.0 * smallest).max(1e-3 * typical) } else { 1e-3 * typical };
    // In loops of several sizes, only the largest ones exceed a large reach.
    let high = *ways.get(ways.len() * 9 / 10)?;
    (low < high).then_some((low, high))
}

/// A harmonic of an angle, searched over integer orders. Orders with more than half a wave between two samples at the
/// slowest motion are aliased with lower orders, so that they are excluded.
fn harmonic_form(view: &View, angle: Signal, orders: RangeInclusive<u32>) -> Vec<Form<'static>> {
    let Some(samples) = view.samples.find(angle).filter(|_| !view.constants.slides) else { return Vec::new() };
    if let Some(followed_hz) = view.constants.followed_hz {
        return whole_orders(orders, highest_followed(samples, view.sample_s, followed_hz), "harmonic", &["a", "b"]);
    }
    let mut steps: Vec<f64> = samples.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|s| *s > 0.0).collect();
    steps.sort_by(f64::total_cmp);
    let Some(slow) = steps.get(steps.len() / 10) else { return Vec::new() };
    let highest = std::f64::consts::PI / slow;
    whole_orders(orders, highest, "harmonic", &["a", "b"])
}

/// Highest order of an angle that the filter passes in more than a fiftieth of the run.
fn highest_followed(angle: &[f64], sample_s: f64, followed_hz: f64) -> f64 {
    let mut steps: Vec<f64> = angle.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
    if steps.is_empty() {
        return 0.0;
    }
    let at = (FOLLOWED_ROWS * steps.len() as f64) as usize;
    let slow = *steps.select_nth_unstable_by(at, f64::total_cmp).1;
    4.0 * std::f64::consts::PI * followed_hz * sample_s / slow.max(f64::MIN_POSITIVE)
}

/// A wave of known order.
fn known_order(order: u32) -> Vec<Form<'static>> {
    whole_orders(order..=order, f64::INFINITY, "harmonic", &["a", "b"])
}

/// A wave over the integer orders up to the highest.
fn whole_orders(
    orders: RangeInclusive<u32>,
    highest: f64,
    name: &'static str,
    linear: &[&'static str],
) -> Vec<Form<'static>> {
    let (first, last) = (f64::from(*orders.start()), f64::from(*orders.end()));
    let grid: Vec<Vec<f64>> = orders.map(f64::from).filter(|h| *h <= highest).map(|h| vec![h]).collect();
    if grid.is_empty() {
        return Vec::new();
    }
    let shape = vec![Shape { name, min: first, max: last, search: ShapeSearch::Whole }];
    vec![Form { name: "harmonic", linear: linear.to_vec(), shape, grid }]
}

/// The same for an axis that may cover only a part of a turn: orders that are repeated.
fn repeated_harmonic_form(view: &View, angle: Signal, orders: RangeInclusive<u32>) -> Vec<Form<'static>> {
    let first = orders.clone().find(|order| is_repeated(view, angle, *order));
    first.map_or_else(Vec::new, |first| harmonic_form(view, angle, first..=*orders.end()))
}

/// Whether the angle covered nearly a whole turn, or two periods of the wave. A shorter section is a curve over the angle,
/// and under gravity a curve over the load.
fn is_repeated(view: &View, angle: Signal, order: u32) -> bool {
    let turns = view.turns(angle);
    turns >= WHOLE_TURN || turns * f64::from(order) >= PERIODS_SEEN
}

/// Name of the form of an effect that may have several harmonics.
pub(crate) const SEVERAL_HARMONICS: &str = "harmonics";

/// A form of harmonics with one more, each with two coefficients.
pub(crate) fn one_more_harmonic(form: &Form) -> Option<(&'static str, Form<'static>)> {
    const LINEAR: [&str; 16] =
        ["a", "b", "a_2", "b_2", "a_3", "b_3", "a_4", "b_4", "a_5", "b_5", "a_6", "b_6", "a_7", "b_7", "a_8", "b_8"];
    const SHAPE: [&str; 8] =
        ["harmonic", "harmonic_2", "harmonic_3", "harmonic_4", "harmonic_5", "harmonic_6", "harmonic_7", "harmonic_8"];
    let count = form.shape.len() + 1;
    let shape = |name: &&'static str| Shape { name, min: 1.0, max: f64::INFINITY, search: ShapeSearch::Whole };
    let shape = SHAPE.get(..count)?.iter().map(shape).collect();
    let form = Form { name: SEVERAL_HARMONICS, linear: LINEAR[..2 * count].to_vec(), shape, grid: Vec::new() };
    Some((SEVERAL_HARMONICS, form))
}

/// Excitation of a run that would distinguish the effect from others.
pub(crate) fn excitation(effect: &dyn Effect) -> &'static str {
    let needs = |column: &str| effect.info().needs.contains(&column);
    if let Some(own) = effect.traits().excitation {
        return own;
    }
    match effect.traits().regime {
        Regime::Hysteresis => "slow reversals over many steps of the encoder",
        Regime::Transient => "faster changes of the speed",
        Regime::SteadyState if effect.traits().wave.is_some() => {
            "more of a turn of that angle, slowly, in both directions"
        }
        Regime::SteadyState if needs("temperature_c") => "the same motion at another temperature",
        Regime::SteadyState if needs("link_torque_nm") => "the same speeds under other loads",
        Regime::SteadyState if needs("link_position_rad") => "more of a turn of the link",
        Regime::SteadyState => match effect.info().kind {
            Kind::Stiffness => "larger and smaller torques, in both directions",
            Kind::Brake => "larger and smaller currents, rising and falling",
            Kind::Friction | Kind::Encoder => "more speeds, in both directions, repeated at other times",
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Signals;

    #[test]
    fn a_wave_over_a_part_of_a_turn_was_there_twice() {
        let first = |turns: f64| {
            let angle: Vec<f64> = (0..4000).map(|i| f64::from(i) / 3999.0 * turns * std::f64::consts::TAU).collect();
            let mut signals = Signals::new(angle.len());
            signals.set(Signal::Link, angle);
            let view = View::new(signals.clone(), signals, Vec::new(), vec![0], 0.01);
            repeated_harmonic_form(&view, Signal::Link, 1..=60).first().map(|f| f.grid[0][0])
        };
        assert_eq!([1.2, 0.5, 0.39, 0.02].map(first), [Some(1.0), Some(4.0), Some(6.0), None]);
    }
}
