//! Presliding hysteresis.

use crate::effect::{Columns, Effect, EffectInfo, Form, Regime, Shape, ShapeSearch, Traits, parameter};
use crate::hysteresis_operators;
use crate::signal::Signal;
use crate::symbolic::{Column, FittedForm, Rule, Symbolic, memory};
use crate::thresholds::CURVE_RANGE;
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Presliding;

pub(crate) const ID: &str = "presliding";

static INFO: EffectInfo = EffectInfo {
    id: ID,
    kind: Kind::Friction,
    title: "Presliding hysteresis",
    sentence: "After a reversal the contacts deform elastically before they slide: friction builds up over a short \
               displacement.",
    formula: "τ_p·(z − sign ω), dz = (1 − z·sign ω)·dθ/θ_p (Dahl); or a stop, dz = dθ/θ_p within ±1; or the mean of four stops with reaches up to θ_p (Maxwell slip); or τ_p·(z − g·sign ω), dz = (1 − z·sign ω/g)·dθ/θ_p, g = 1 + ρ·exp(−(ω/ω_s)²) (LuGre)",
    source: "Dahl 1968; Canudas de Wit, Olsson, Åström, Lischinsky 1995; Al-Bender, Lampaert, Swevers 2005",
    looks: "hysteresis loops at reversals: torque lags behind the change of direction",
    parameters: &[
        parameter("tau_p", "Nm", 0.0, f64::INFINITY),
        parameter("theta_p", "rad", 0.0, f64::INFINITY),
        parameter("omega_s", "rad/s", 0.0, f64::INFINITY),
        parameter("rho", "1", 0.0, f64::INFINITY),
    ],
    needs: &[],
};

impl Effect for Presliding {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let Some((low, high)) = crate::effects::reversal_range(view) else { return Vec::new() };
        let reach = Shape { name: "theta_p", min: low, max: high, search: ShapeSearch::Smooth };
        let grid: Vec<Vec<f64>> = crate::effects::log_grid(low, high, 7).into_iter().map(|d| vec![d]).collect();
        let one = |name| Form { name, linear: vec!["tau_p"], shape: vec![reach], grid: grid.clone() };
        let mut forms = vec![one("dahl"), one("stop"), one("maxwell_slip")];
        // For a trajectory judged sample by sample, the Stribeck effect determines the decrease with speed.
        let apart = !view.chunks.is_empty();
        let range = crate::effects::speed_range(view).filter(|(slow, fast)| apart && *fast > CURVE_RANGE * slow);
        if let Some((slow, fast)) = range {
            let speed = Shape { name: "omega_s", min: slow, max: fast, search: ShapeSearch::Smooth };
            let rise = Shape { name: "rho", min: 0.05, max: 3.0, search: ShapeSearch::Smooth };
            let middle = (slow * fast).sqrt();
            let grid = crate::effects::log_grid(low, high, 4).into_iter().map(|d| vec![d, middle, 0.4]).collect();
            forms.push(Form { name: "lugre", linear: vec!["tau_p"], shape: vec![reach, speed, rise], grid });
        }
        forms
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        let position = view.samples.find(Signal::Position).unwrap_or_default();
        let direction = view.samples.find(Signal::Direction).unwrap_or_default();
        let relative_to_direction = |state: Vec<f64>| state.iter().zip(direction).map(|(z, d)| z - d).collect();
        vec![view.average(match form {
            "dahl" => relative_to_direction(hysteresis_operators::dahl(position, shape[0], &view.starts)),
            "maxwell_slip" => {
                relative_to_direction(hysteresis_operators::maxwell_slip(position, shape[0], &view.starts))
            }
            "lugre" => {
                let velocity = view.samples.find(Signal::Velocity).unwrap_or_default();
                let strength: Vec<f64> =
                    velocity.iter().map(|w| 1.0 + shape[2] * (-(w / shape[1]).powi(2)).exp()).collect();
                let state = hysteresis_operators::lugre(position, &strength, shape[0], &view.starts);
                state.iter().zip(&strength).zip(direction).map(|((z, g), d)| z - g * d).collect()
            }
            _ => relative_to_direction(hysteresis_operators::stop(position, shape[0], &view.starts)),
        })]
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        let rule = Rule::of(form.name);
        match form.name {
            "lugre" => Ok(vec![Column::Memory {
                rule,
                signal: "position",
                reach: 0,
                end: "1 + rho * exp(-(velocity / omega_s) ^ 2)",
                formula: "z - (1 + rho * exp(-(velocity / omega_s) ^ 2)) * direction",
            }]),
            _ => memory(rule, "position", "z - direction"),
        }
    }

    fn traits(&self) -> Traits {
        Traits { regime: Regime::Hysteresis, changes_direction: true, ..Traits::default() }
    }
}
