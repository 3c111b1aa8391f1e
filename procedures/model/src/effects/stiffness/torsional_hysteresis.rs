//! Torsional hysteresis.

use crate::effect::{Columns, Effect, EffectInfo, Form, Shape, ShapeSearch, parameter};
use crate::hysteresis_operators;
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Rule, Symbolic, component};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct TorsionalHysteresis;

/// Parameters of the components of a sum.
const SIZES: [&str; 3] = ["eta", "eta_2", "eta_3"];
const REACHES: [&str; 3] = ["tau_eta", "tau_eta_2", "tau_eta_3"];

static INFO: EffectInfo = EffectInfo {
    id: "torsional_hysteresis",
    kind: Kind::Stiffness,
    title: "Torsional hysteresis",
    sentence: "Torsion depends on the history of the torque (hysteresis loop).",
    formula: "η·z, dz = (1 − z·sign dτ)·dτ/τ_η (Dahl), or a stop dz = dτ/τ_η within ±1, or the mean of four stops with reaches up to τ_η (Maxwell slip); or one of these with one or two more stops",
    source: "Dahl 1968; Al-Bender, Lampaert, Swevers 2005; Ruderman, Bertram, Iwasaki 2014",
    looks: "a loop over torque, independent of the sweep direction",
    parameters: &[
        parameter("eta", "rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("tau_eta", "Nm", 0.0, f64::INFINITY),
        parameter("eta_2", "rad", f64::NEG_INFINITY, f64::INFINITY),
        parameter("eta_3", "rad", f64::NEG_INFINITY, f64::INFINITY),
    ],
    needs: &[],
};

impl Effect for TorsionalHysteresis {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let peak = view.peak(Signal::Load);
        let shape = vec![Shape { name: "tau_eta", min: 0.02 * peak, max: peak, search: ShapeSearch::Smooth }];
        let grid: Vec<Vec<f64>> = crate::effects::log_grid(0.02 * peak, peak, 8).into_iter().map(|t| vec![t]).collect();
        let one = |name| Form { name, linear: vec!["eta"], shape: shape.clone(), grid: grid.clone() };
        vec![one("dahl"), one("stop"), one("maxwell_slip")]
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        let torque = view.samples.find(Signal::Load).unwrap_or_default();
        let column = |(part, reach): (usize, &f64)| {
            view.average(match form {
                "dahl" | "dahl_and_stops" if part == 0 => hysteresis_operators::dahl(torque, *reach, &view.starts),
                "maxwell_slip" | "maxwell_slip_and_stops" if part == 0 => {
                    hysteresis_operators::maxwell_slip(torque, *reach, &view.starts)
                }
                _ => hysteresis_operators::stop(torque, *reach, &view.starts),
            })
        };
        shape.iter().enumerate().map(column).collect()
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        let first = component(0, Rule::of(form.name), "load", "z");
        let stops = (1..form.shape).map(|k| component(k, Rule::Stop, "load", "z"));
        Ok(std::iter::once(first).chain(stops).collect())
    }

    /// Dry contacts that slip one after the other, each with its own strength.
    fn extended(&self, form: &Form) -> Option<(&'static str, Form<'static>)> {
        let name = match form.name {
            "dahl" | "dahl_and_stops" => "dahl_and_stops",
            "maxwell_slip" | "maxwell_slip_and_stops" => "maxwell_slip_and_stops",
            _ => "stops",
        };
        let parts = form.shape.len() + 1;
        let shape = |name: &&'static str| Shape { name, ..form.shape[0] };
        let shape = REACHES.get(..parts)?.iter().map(shape).collect();
        Some(("stop", Form { name, linear: SIZES[..parts].to_vec(), shape, grid: Vec::new() }))
    }
}
