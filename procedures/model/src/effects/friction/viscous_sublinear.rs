//! Shear-thinning viscous friction.

use crate::effect::{Columns, Effect, EffectInfo, Form, Shape, ShapeSearch, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::thresholds::CURVE_RANGE;
use crate::view::View;
use jointbench_instrument::Kind;

pub struct ViscousSublinear;

static INFO: EffectInfo = EffectInfo {
    id: "viscous_sublinear",
    kind: Kind::Friction,
    title: "Shear-thinning viscous friction",
    sentence: "Shear thinning of grease: drag grows less than in proportion to speed.",
    formula: "c_α·|ω|^α·sign ω, α < 1; or τ_l·(1 − exp(−|ω|/ω_l))·sign ω, a limiting shear stress",
    source: "Harnoy, Friedland, Cohn 2008; Bair, Winer 1979 (limiting shear stress)",
    looks: "a curve over speed, steep at first, then flat; sign changes with the direction",
    parameters: &[
        parameter("c_alpha", "Nm·(s/rad)^α", 0.0, f64::INFINITY),
        parameter("alpha", "1", 0.15, 0.85),
        parameter("tau_l", "Nm", 0.0, f64::INFINITY),
        parameter("omega_l", "rad/s", 0.0, f64::INFINITY),
    ],
    needs: &[],
};

/// Forms for a run that is judged sample by sample, including those that saturate within a reversal.
fn sampled(fastest: f64) -> Vec<Form<'static>> {
    const LIMITS: [f64; 2] = [0.007, 0.5];
    let shape = vec![Shape { name: "alpha", min: 0.15, max: 0.85, search: ShapeSearch::Smooth }];
    let grid = [0.15, 0.3, 0.5, 0.7, 0.85].map(|alpha| vec![alpha]).to_vec();
    let power = Form { name: "power", linear: vec!["c_alpha"], shape, grid };
    let [low, high] = LIMITS.map(|share| share * fastest);
    let shape = vec![Shape { name: "omega_l", min: low, max: high, search: ShapeSearch::Smooth }];
    let grid = crate::effects::log_grid(low, high, 8).into_iter().map(|w| vec![w]).collect();
    vec![power, Form { name: "limited", linear: vec!["tau_l"], shape, grid }]
}

impl Effect for ViscousSublinear {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        if let Some(fastest) = view.constants.speeds {
            return sampled(fastest);
        }
        let Some((slow, fast)) = crate::effects::speed_range(view).filter(|(slow, fast)| *fast >= CURVE_RANGE * slow)
        else {
            return Vec::new();
        };
        let shape = vec![Shape { name: "alpha", min: 0.15, max: 0.85, search: ShapeSearch::Smooth }];
        let grid = [0.25, 0.4, 0.55, 0.7].iter().map(|a| vec![*a]).collect();
        let power = Form { name: "power", linear: vec!["c_alpha"], shape, grid };
        let (low, high) = (slow, fast / CURVE_RANGE);
        if high < 2.0 * low {
            return vec![power];
        }
        let shape = vec![Shape { name: "omega_l", min: low, max: high, search: ShapeSearch::Smooth }];
        let grid = crate::effects::log_grid(low, high, 4).into_iter().map(|w| vec![w]).collect();
        vec![power, Form { name: "limited", linear: vec!["tau_l"], shape, grid }]
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        vec![match form {
            "limited" => view.map2(Signal::Velocity, Signal::Direction, |w, d| (1.0 - (-w.abs() / shape[0]).exp()) * d),
            _ => view.map2(Signal::Velocity, Signal::Direction, |w, d| w.abs().powf(shape[0]) * d),
        }]
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        match form.name {
            "limited" => formula("(1 - exp(-abs(velocity) / omega_l)) * direction"),
            _ => formula("abs(velocity) ^ alpha * direction"),
        }
    }
}
