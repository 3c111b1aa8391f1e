//! Saturation.

use crate::effect::{Columns, Effect, EffectInfo, Form, Shape, ShapeSearch, parameter};
use crate::signal::Signal;
use crate::symbolic::{Column, FittedForm, Symbolic, formula};
use crate::view::View;
use jointbench_instrument::Kind;

pub struct Saturation;

/// Coefficients of the Chebyshev polynomials of degree 2 to 8, for any smooth curve.
const CURVE: [&str; 7] = ["k_2", "k_3", "k_4", "k_5", "k_6", "k_7", "k_8"];

static INFO: EffectInfo = EffectInfo {
    id: "saturation",
    kind: Kind::Brake,
    title: "Saturation",
    sentence: "The torque is not proportional to the current: the curve bends as the iron saturates.",
    formula: "c_2·i² + c_3·i³, also up to i⁵, or c·tanh((i − i_0)/i_s), or c·tanh(i/i_s), or Σ k_n·(T_n(2·i/i_max − 1) − T_n(−1))",
    source: "Data sheets of hysteresis brakes (torque over current)",
    looks: "a curve over current, equal for rising and falling current",
    parameters: &[
        parameter("c_2", "Nm/A²", f64::NEG_INFINITY, f64::INFINITY),
        parameter("c_3", "Nm/A³", f64::NEG_INFINITY, f64::INFINITY),
        parameter("c_4", "Nm/A⁴", f64::NEG_INFINITY, f64::INFINITY),
        parameter("c_5", "Nm/A⁵", f64::NEG_INFINITY, f64::INFINITY),
        parameter("c", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("i_0", "A", 0.0, f64::INFINITY),
        parameter("i_s", "A", 0.0, f64::INFINITY),
        parameter("k_2", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("k_3", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("k_4", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("k_5", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("k_6", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("k_7", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("k_8", "Nm", f64::NEG_INFINITY, f64::INFINITY),
        parameter("i_max", "A", 0.0, f64::INFINITY),
    ],
    needs: &[],
};

impl Effect for Saturation {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let peak = view.peak(Signal::Current);
        let bend = Shape { name: "i_s", min: 0.05 * peak, max: 2.0 * peak, search: ShapeSearch::Smooth };
        let onset = Shape { name: "i_0", min: 0.01 * peak, max: peak, search: ShapeSearch::Smooth };
        // The range of the curve is stored with the fit, because another run has another largest current.
        let range = Shape { name: "i_max", min: peak, max: peak, search: ShapeSearch::Whole };
        let widths = crate::effects::log_grid(0.1 * peak, 1.5 * peak, 4);
        let onsets = [0.1, 0.3, 0.6].map(|o| o * peak);
        let pairs = onsets.iter().flat_map(|o| widths.iter().map(|w| vec![*o, *w])).collect();
        vec![
            Form { name: "polynomial", linear: vec!["c_2", "c_3"], shape: Vec::new(), grid: vec![Vec::new()] },
            Form {
                name: "quintic",
                linear: vec!["c_2", "c_3", "c_4", "c_5"],
                shape: Vec::new(),
                grid: vec![Vec::new()],
            },
            Form {
                name: "tanh",
                linear: vec!["c"],
                shape: vec![bend],
                grid: widths.iter().map(|w| vec![*w]).collect(),
            },
            Form { name: "s_shape", linear: vec!["c"], shape: vec![onset, bend], grid: pairs },
            Form { name: "curve", linear: CURVE.to_vec(), shape: vec![range], grid: vec![vec![peak]] },
        ]
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        match form {
            "polynomial" => [2, 3].map(|n| view.map(Signal::Current, |i| i.powi(n))).into(),
            "quintic" => [2, 3, 4, 5].map(|n| view.map(Signal::Current, |i| i.powi(n))).into(),
            "tanh" => vec![view.map(Signal::Current, |i| (i / shape[0]).tanh())],
            "curve" => (2..)
                .take(CURVE.len())
                .map(|n| view.map(Signal::Current, |i| chebyshev(n, 2.0 * i / shape[0] - 1.0) - chebyshev(n, -1.0)))
                .collect(),
            _ => vec![view.map(Signal::Current, |i| ((i - shape[0]) / shape[1]).tanh() + (shape[0] / shape[1]).tanh())],
        }
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        let power = |n: usize| Column::Formula(vec!["current"; n].join(" * "));
        match form.name {
            "polynomial" => Ok([2, 3].map(power).into()),
            "quintic" => Ok([2, 3, 4, 5].map(power).into()),
            "curve" => Ok((2..).take(form.linear).map(|n| Column::Formula(from_zero(n))).collect()),
            "tanh" => formula("tanh(current / i_s)"),
            _ => formula("tanh((current - i_0) / i_s) + tanh(i_0 / i_s)"),
        }
    }
}

/// Chebyshev polynomial minus its value at zero current, as a formula for a controller.
fn from_zero(degree: usize) -> String {
    let sign = if degree.is_multiple_of(2) { '-' } else { '+' };
    format!("({} {sign} 1)", horner(degree))
}

/// Chebyshev polynomial over the range of currents, by Horner's rule.
fn horner(degree: usize) -> String {
    let next = |before: &[i64], now: &[i64]| -> Vec<i64> {
        let at = |c: &[i64], k: Option<usize>| k.and_then(|k| c.get(k)).copied().unwrap_or(0);
        (0..=now.len()).map(|k| 2 * at(now, k.checked_sub(1)) - at(before, Some(k))).collect()
    };
    let (_, coefficients) =
        (1..degree).fold((vec![1], vec![0, 1]), |(before, now), _| (now.clone(), next(&before, &now)));
    let rest = coefficients.iter().rev().map(i64::to_string);
    rest.reduce(|inner, coefficient| format!("({inner}) * (2 * current / i_max - 1) + {coefficient}"))
        .unwrap_or_default()
}

fn chebyshev(degree: usize, x: f64) -> f64 {
    (1..degree).fold((1.0, x), |(before, now), _| (now, 2.0 * x * now - before)).1
}
