//! Hysteresis.

use crate::effect::{Columns, Effect, EffectInfo, Form, Shape, ShapeSearch, parameter};
use crate::hysteresis_operators;
use crate::signal::Signal;
use crate::stats::summary::range;
use crate::symbolic::{Column, FittedForm, Rule, Symbolic, memory};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Hysteresis;

/// Bands of stop operators, evenly spaced up to the largest reach.
const BANDS: [&str; 8] = ["h_1", "h_2", "h_3", "h_4", "h_5", "h_6", "h_7", "h_8"];
/// Forms by their number of bands, so that fewer are used if they suffice.
const FORMS: [(&str, usize); 3] = [("bands_3", 3), ("bands_5", 5), ("bands", 8)];
/// Stop operators in a band: a smooth density with few coefficients instead of many independent weights.
const STOPS: usize = 6;

pub(crate) const ID: &str = "hysteresis";

static INFO: EffectInfo = EffectInfo {
    id: ID,
    kind: Kind::Brake,
    title: "Hysteresis",
    sentence: "At the same current the torque is higher while the current falls than while it rises.",
    formula: "h·(z + 1), stop dz = di/r within ±1 or Dahl; or Σ h_k·(z_k + 1) over bands of stops with reaches up to i_max, half of the range of the current",
    source: "Kuhnen 2003, modified Prandtl–Ishlinskii model",
    looks: "a loop over current",
    parameters: &[
        parameter("h_1", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("h_2", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("h_3", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("h_4", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("h_5", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("h_6", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("h_7", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("h_8", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("h", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("r", "A", 0.0, f64::INFINITY),
        parameter("i_max", "A", 0.0, f64::INFINITY),
    ],
    needs: &[],
};

impl Effect for Hysteresis {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let peak = view.peak(Signal::Current);
        let shape = vec![Shape { name: "r", min: 0.02 * peak, max: peak, search: ShapeSearch::Smooth }];
        let grid: Vec<Vec<f64>> = crate::effects::log_grid(0.05 * peak, peak, 4).into_iter().map(|t| vec![t]).collect();
        let turns = view.samples.find(Signal::Current).is_some_and(|i| hysteresis_operators::turns(i, 0.1 * peak));
        if !turns {
            return Vec::new();
        }
        let one = |name| Form { name, linear: vec!["h"], shape: shape.clone(), grid: grid.clone() };

        // A stop with a reach of more than half the range never slips on the way back. It is then confounded with a
        // straight line. The positions of the bands are stored with the fit, because another run has another range.
        let current = view.samples.find(Signal::Current).unwrap_or_default();
        let ends = range(current);
        let most = (ends.1 - ends.0) / 2.0;
        let reach = Shape { name: "i_max", min: most, max: most, search: ShapeSearch::Whole };
        let several = |(name, bands): (&'static str, usize)| Form {
            name,
            linear: BANDS[..bands].to_vec(),
            shape: vec![reach],
            grid: vec![vec![most]],
        };
        [one("stop"), one("dahl")].into_iter().chain(FORMS.map(several)).collect()
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        let current = view.samples.find(Signal::Current).unwrap_or_default();
        match form {
            "stop" => vec![view.average(relative_to_rest(hysteresis_operators::stop(current, shape[0], &view.starts)))],
            "dahl" => vec![view.average(relative_to_rest(hysteresis_operators::dahl(current, shape[0], &view.starts)))],
            _ => {
                let bands = FORMS.iter().find(|known| known.0 == form).map_or(BANDS.len(), |known| known.1);
                density(current, shape[0], bands, view)
            }
        }
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        let bands = form.linear;
        match FORMS.iter().any(|known| known.0 == form.name) {
            true => Ok((0..bands).map(|band| Column::Band { stops: STOPS * bands, bands, band }).collect()),
            false => memory(Rule::of(form.name), "current", "z + 1"),
        }
    }
}

/// A hysteresis state relative to the one after the current has fallen to zero: the torque in that state counts as
/// drag.
fn relative_to_rest(mut state: Vec<f64>) -> Vec<f64> {
    state.iter_mut().for_each(|z| *z += 1.0);
    state
}

/// Stop operators weighted by hat functions of their reach: each band rises to its knot and falls to the next.
fn density(current: &[f64], reach: f64, bands: usize, view: &View) -> Columns {
    let mut columns = vec![vec![0.0; view.len()]; bands];
    let stops = STOPS * bands;
    for k in 1..=stops {
        let place = k as f64 / STOPS as f64;
        let stop = hysteresis_operators::stop(current, reach * k as f64 / stops as f64, &view.starts);
        let stop = view.average(relative_to_rest(stop));
        for (band, column) in columns.iter_mut().enumerate() {
            let weight = (1.0 - (place - (band + 1) as f64).abs()).max(0.0);
            if weight > 0.0 {
                column.iter_mut().zip(&stop).for_each(|(c, s)| *c += weight * s);
            }
        }
    }
    columns
}
