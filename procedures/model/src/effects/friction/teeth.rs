//! Torque that the gear teeth transmit: the measured load, plus the link's weight if the sensor does not measure it.

use crate::effect::{Form, ParameterInfo, Shape, ShapeSearch, parameter};
use crate::signal::Signal;
use crate::view::View;

/// Name of the form with a weight that no sensor measures.
pub const WITH_WEIGHT: &str = "with_weight";

/// Gravity torque on the motor side, once per link turn.
pub const COS: ParameterInfo = parameter("g_c", "Nm", f64::NEG_INFINITY, f64::INFINITY);
pub const SIN: ParameterInfo = parameter("g_s", "Nm", f64::NEG_INFINITY, f64::INFINITY);

/// Torque that the gear teeth transmit if the sensor does not measure the weight, as a formula for a controller.
pub const TORQUE: &str = "load + g_c * cos(link_position) + g_s * sin(link_position)";

/// Search range: twice the gravity torque in the motor torque, with either sign.
const REACH: f64 = 2.0;

/// Forms of an effect with one coefficient over the load, and over load and weight together if there is such a
/// weight.
pub fn forms(view: &View, coefficient: &'static str) -> Vec<Form<'static>> {
    if !view.bears_load() {
        return Vec::new();
    }
    let plain = Form::linear(&[coefficient]);
    let Some(weight) = view.constants.weight.filter(|_| !view.constants.slides) else { return vec![plain] };
    let most = REACH * weight[0].hypot(weight[1]);
    let shape = ["g_c", "g_s"].map(|name| Shape { name, min: -most, max: most, search: ShapeSearch::Signed });
    let form = Form { name: WITH_WEIGHT, linear: vec![coefficient], shape: shape.into(), grid: vec![weight.into()] };
    vec![plain, form]
}

/// Transmitted torque of the gear teeth on the motor side.
pub fn bear(shape: &[f64], view: &View) -> Vec<f64> {
    let load = view.get(Signal::Load);
    let [g_c, g_s] = shape else { return load.to_vec() };
    let [cos, sin] = view.harmonic(Signal::Link, 1.0);
    load.iter().zip(cos.iter().zip(&sin)).map(|(l, (c, s))| l + g_c * c + g_s * s).collect()
}
