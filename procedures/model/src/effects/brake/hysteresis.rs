//! Hysteresis.

use crate::effect::{Columns, Effect, EffectInfo, Form, Search, Shape, parameter};
use crate::effects::memory;
use crate::view::{Signal, View};
use jointbench_instrument::Kind;

pub struct Hysteresis;

/// Bands of stops, evenly up to the largest current.
const BANDS: [&str; 8] = ["h_1", "h_2", "h_3", "h_4", "h_5", "h_6", "h_7", "h_8"];
/// Stops that make up the bands: a smooth density of a few numbers instead of many loose weights.
const STOPS: usize = 48;

static INFO: EffectInfo = EffectInfo {
    id: "hysteresis",
    kind: Kind::Brake,
    title: "Hysteresis",
    sentence: "At the same current the brake holds more on the way down than on the way up.",
    formula: "h·z, stop dz = di/r within ±1 or Dahl; or Σ h_k·z_k over bands of stops with reaches up to the largest current",
    source: "Prandtl–Ishlinskii model: Kuhnen 2003",
    looks: "loops over current",
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
        let shape = vec![Shape { name: "r", min: 0.02 * peak, max: peak, search: Search::Smooth }];
        let grid: Vec<Vec<f64>> = crate::effects::log_grid(0.05 * peak, peak, 4).into_iter().map(|t| vec![t]).collect();
        let turns = view.samples.find(Signal::Current).is_some_and(|i| memory::turns(i, 0.1 * peak));
        if !turns {
            return Vec::new();
        }
        let one = |name| Form { name, linear: vec!["h"], shape: shape.clone(), grid: grid.clone() };

        // Where the bands lie belongs to the fit: another run has another largest current.
        let reach = Shape { name: "i_max", min: peak, max: peak, search: Search::Whole };
        vec![
            one("stop"),
            one("dahl"),
            Form { name: "bands", linear: BANDS.to_vec(), shape: vec![reach], grid: vec![vec![peak]] },
        ]
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        let current = view.samples.find(Signal::Current).unwrap_or_default();
        match form {
            "stop" => vec![view.average(memory::stop(current, shape[0], &view.starts))],
            "dahl" => vec![view.average(memory::dahl(current, shape[0], &view.starts))],
            _ => bands(current, shape[0], view),
        }
    }
}

/// Stops weighted by hats over their reach: each band rises to its knot and falls to the next.
fn bands(current: &[f64], peak: f64, view: &View) -> Columns {
    let mut columns = vec![vec![0.0; view.len()]; BANDS.len()];
    for k in 1..=STOPS {
        let place = (k * BANDS.len()) as f64 / STOPS as f64;
        let stop = view.average(memory::stop(current, peak * k as f64 / STOPS as f64, &view.starts));
        for (band, column) in columns.iter_mut().enumerate() {
            let weight = (1.0 - (place - (band + 1) as f64).abs()).max(0.0);
            if weight > 0.0 {
                column.iter_mut().zip(&stop).for_each(|(c, s)| *c += weight * s);
            }
        }
    }
    columns
}
