//! Stribeck effect.

use crate::effect::{Columns, Effect, EffectInfo, Form, Shape, ShapeSearch, Traits, parameter};
use crate::fast_math;
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;
use multiversion::multiversion;

pub struct Stribeck;

static INFO: EffectInfo = EffectInfo {
    id: "stribeck",
    kind: Kind::Friction,
    title: "Stribeck effect",
    sentence: "At low speed the lubricant film breaks down and friction rises towards zero speed.",
    formula: "τ_s·exp(−(|ω|/ω_s)^δ)·sign ω",
    source: "Stribeck 1902; Bo, Pavelescu 1982",
    looks: "a rise at the lowest speeds, sign changes with the direction",
    parameters: &[
        parameter("tau_s", "Nm", 0.0, f64::INFINITY),
        parameter("omega_s", "rad/s", 0.0, f64::INFINITY),
        parameter("delta", "1", 0.5, 3.0),
    ],
    needs: &[],
};

/// exp(−(|ω|/ω_s)^δ)·sign ω of each point
pub(crate) fn fading(view: &View, shape: &[f64]) -> Vec<f64> {
    let mut out = view.get(Signal::Direction).to_vec();
    fade(&mut out, view.get(Signal::Velocity), 1.0 / shape[0], shape[1]);
    out
}

#[multiversion(targets("x86_64+avx512f+avx512dq", "x86_64+avx2"))]
fn fade(column: &mut [f64], velocity_rad_s: &[f64], per_speed: f64, delta: f64) {
    for (value, w) in column.iter_mut().zip(velocity_rad_s) {
        // A speed of zero has no logarithm.
        let power = fast_math::exp(delta * fast_math::ln(w.abs() * per_speed + f64::MIN_POSITIVE));
        *value *= fast_math::exp(-power);
    }
}

/// Speeds and exponents that this data can identify: between its slowest motion and a third of its fastest.
pub(crate) fn search(view: &View) -> Option<(Vec<Shape<'static>>, Vec<Vec<f64>>)> {
    if let Some(fastest) = view.constants.speeds {
        return Some(sampled(fastest));
    }
    let (slow, fast) = crate::effects::speed_range(view)?;
    let (low, high) = (slow * 0.7, fast / 3.0);
    if high < 2.0 * low {
        return None;
    }
    let shape = vec![
        Shape { name: "omega_s", min: low, max: high, search: ShapeSearch::Smooth },
        Shape { name: "delta", min: 0.5, max: 3.0, search: ShapeSearch::Smooth },
    ];
    let speeds = crate::effects::log_grid(low, high, 6);
    let grid = speeds.iter().flat_map(|s| [vec![*s, 0.9], vec![*s, 1.8]]).collect();
    Some((shape, grid))
}

/// The same for a run that is judged sample by sample. It includes speeds within a reversal, because nuisance columns
/// represent other forms there.
fn sampled(fastest: f64) -> (Vec<Shape<'static>>, Vec<Vec<f64>>) {
    let (low, high) = (0.002 * fastest, fastest / 3.0);
    let shape = vec![
        Shape { name: "omega_s", min: low, max: high, search: ShapeSearch::Smooth },
        Shape { name: "delta", min: 0.5, max: 3.0, search: ShapeSearch::Smooth },
    ];
    let speeds = crate::effects::log_grid(low, high, 10);
    (shape, speeds.iter().flat_map(|s| [0.5, 1.0, 2.0].map(|delta| vec![*s, delta])).collect())
}

impl Effect for Stribeck {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let Some((shape, grid)) = search(view) else { return Vec::new() };
        vec![Form { name: "exponential", linear: vec!["tau_s"], shape, grid }]
    }

    fn columns(&self, _: &str, shape: &[f64], view: &View) -> Columns {
        vec![fading(view, shape)]
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        formula("exp(-(abs(velocity) / omega_s) ^ delta) * direction")
    }

    fn traits(&self) -> Traits {
        Traits { exponent_parameter: Some("delta"), corrects: Some("coulomb"), ..Traits::default() }
    }
}
