//! Torque that the gear teeth transmit: the measured load, plus the link's weight if the sensor does not measure it. Without
//! a sensor it is the weight alone (Duclusaud et al. 2025, pendulums).

use crate::effect::{Form, ParameterInfo, Shape, ShapeSearch, parameter};
use crate::signal::Signal;
use crate::view::View;

/// Name of the form with a weight that no sensor measures.
pub const WITH_WEIGHT: &str = "with_weight";

/// Name of the form with a weight and no sensor.
pub const ONLY_WEIGHT: &str = "only_weight";

/// Gravity torque on the motor side, once per link turn.
pub const COS: ParameterInfo = parameter("g_c", "Nm", f64::NEG_INFINITY, f64::INFINITY);
pub const SIN: ParameterInfo = parameter("g_s", "Nm", f64::NEG_INFINITY, f64::INFINITY);

/// Torque that the gear teeth transmit, as a formula for a controller.
pub fn torque(form: &str) -> &'static str {
    match form {
        WITH_WEIGHT => "(load + g_c * cos(link_position) + g_s * sin(link_position))",
        ONLY_WEIGHT => "(g_c * cos(link_position) + g_s * sin(link_position))",
        _ => "load",
    }
}

/// Search range: twice the gravity torque in the motor torque, with either sign.
const REACH: f64 = 2.0;

/// Forms of an effect with one coefficient over the load, and over load and weight together if there is such a
/// weight. The scale of a weight without a sensor cannot be distinguished from the coefficient: it is that of the
/// gravity torque.
pub fn forms(view: &View, coefficient: &'static str) -> Vec<Form<'static>> {
    let of_weight = |name, weight: [f64; 2], bounds: [(f64, f64); 2]| {
        let shape = |name, (min, max)| Shape { name, min, max, search: ShapeSearch::Signed };
        let shape = vec![shape("g_c", bounds[0]), shape("g_s", bounds[1])];
        Form { name, linear: vec![coefficient], shape, grid: vec![weight.into()] }
    };
    if let Some(weight) = only_weight(view) {
        return vec![of_weight(ONLY_WEIGHT, weight, weight.map(|fixed| (fixed, fixed)))];
    }
    if !view.bears_load() {
        return Vec::new();
    }
    let with_weight = weight(view).map(|weight| {
        let most = REACH * weight[0].hypot(weight[1]);
        of_weight(WITH_WEIGHT, weight, [(-most, most); 2])
    });
    [Form::linear(&[coefficient])].into_iter().chain(with_weight).collect()
}

/// The column that an effect of the load lacks: none if the weight of the link is a known load.
pub fn missing(view: &View) -> Option<&'static str> {
    (view.find(Signal::Load).is_none() && only_weight(view).is_none()).then_some("link_torque_nm")
}

fn weight(view: &View) -> Option<[f64; 2]> {
    view.constants.weight.filter(|_| !view.constants.slides)
}

/// The weight of the link, if it is a load that no sensor measures.
fn only_weight(view: &View) -> Option<[f64; 2]> {
    let is_alone =
        |weight: &[f64; 2]| view.find(Signal::Load).is_none() && view.is_load(&transmitted_torque(weight, view));
    weight(view).filter(is_alone)
}

/// Transmitted torque of the gear teeth on the motor side.
pub fn transmitted_torque(shape: &[f64], view: &View) -> Vec<f64> {
    let load = view.get(Signal::Load);
    let [g_c, g_s] = shape else { return load.to_vec() };
    let [cos, sin] = view.harmonic(Signal::Link, 1.0);
    load.iter().zip(cos.iter().zip(&sin)).map(|(l, (c, s))| l + g_c * c + g_s * s).collect()
}
