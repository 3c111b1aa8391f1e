//! Hysteresis.

use crate::effect::{Columns, Effect, EffectInfo, Form, Search, Shape, parameter};
use crate::effects::memory;
use crate::view::{Signal, View};
use jointbench_instrument::Kind;

pub struct Hysteresis;

static INFO: EffectInfo = EffectInfo {
    id: "hysteresis",
    kind: Kind::Brake,
    title: "Hysteresis",
    sentence: "At the same current the brake holds more on the way down than on the way up.",
    formula: "Σ h_k·z_k, stops dz_k = di/r_k within ±1, r_k fractions of the largest current",
    source: "Prandtl–Ishlinskii model: Kuhnen 2003",
    looks: "loops over current",
    parameters: &[
        parameter("h_1", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("h_2", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("h_3", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("h_4", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("h_5", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("h_6", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("h", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("r", "A", 0.0, f64::INFINITY),
    ],
    needs: &[],
};

impl Effect for Hysteresis {
    fn info(&self) -> &'static EffectInfo {
        &INFO
    }

    fn forms(&self, view: &View) -> Vec<Form> {
        let peak = view.peak(Signal::Current);
        let shape = vec![Shape { name: "r", min: 0.02 * peak, max: peak, search: Search::Smooth }];
        let grid: Vec<Vec<f64>> = crate::effects::log_grid(0.05 * peak, peak, 4).into_iter().map(|t| vec![t]).collect();
        let turns = view.samples.find(Signal::Current).is_some_and(|i| memory::turns(i, 0.1 * peak));
        if !turns {
            return Vec::new();
        }
        let one = |name| Form { name, linear: &["h"], shape: shape.clone(), grid: grid.clone() };
        let several = &["h_1", "h_2", "h_3", "h_4", "h_5", "h_6"];
        vec![
            one("stop"),
            one("dahl"),
            Form { name: "stops", linear: several, shape: Vec::new(), grid: vec![Vec::new()] },
        ]
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        let current = view.samples.find(Signal::Current).unwrap_or_default();
        match form {
            "stop" => vec![view.average(memory::stop(current, shape[0], &view.starts))],
            "dahl" => vec![view.average(memory::dahl(current, shape[0], &view.starts))],
            _ => {
                let peak = view.peak(Signal::Current);
                let reach = [0.08, 0.16, 0.3, 0.5, 0.75, 1.0].map(|s| s * peak);
                reach.iter().map(|r| view.average(memory::stop(current, *r, &view.starts))).collect()
            }
        }
    }
}
