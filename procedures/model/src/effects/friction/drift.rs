//! Drift with time.

use crate::effect::{Columns, Effect, EffectInfo, Form, Shape, ShapeSearch, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::thresholds::DRIFT_START;
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Drift;

static INFO: EffectInfo = EffectInfo {
    id: "drift",
    kind: Kind::Friction,
    title: "Drift with time",
    sentence: "The torque drifts slowly during the run, such as the zero of a sensor that warms up.",
    formula: "d·t, or d_e·(1 − exp(−t/t_d)) if it saturates; zero at the first sample",
    source: "JCGM 200:2012 (VIM), 4.21 instrumental drift",
    looks: "a line over time or a curve that flattens, equal in both directions",
    parameters: &[
        parameter("d", "Nm/s", f64::NEG_INFINITY, f64::INFINITY),
        parameter("d_e", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("t_d", "s", 0.0, f64::INFINITY),
    ],
    needs: &[],
};

impl Effect for Drift {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let line = Form::linear(&["d"]);
        // A shorter time constant is an offset for most of the run, and a longer one than the run is a line within 4
        // %.
        let high = view.get(Signal::Time).iter().fold(0.0f64, |m, t| m.max(*t));
        if high <= 0.0 {
            return vec![line];
        }
        let low = DRIFT_START * high;
        let shape = vec![Shape { name: "t_d", min: low, max: high, search: ShapeSearch::Smooth }];
        let grid = crate::effects::log_grid(low, high, 4).into_iter().map(|t| vec![t]).collect();
        vec![line, Form { name: "settling", linear: vec!["d_e"], shape, grid }]
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        vec![match form {
            "settling" => view.map(Signal::Time, |t| 1.0 - (-t / shape[0]).exp()),
            _ => view.get(Signal::Time).to_vec(),
        }]
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        match form.name {
            "settling" => formula("1 - exp(-time / t_d)"),
            _ => formula("time"),
        }
    }
}
