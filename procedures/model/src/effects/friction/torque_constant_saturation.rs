//! Saturation of the torque constant.

use crate::effect::{Columns, Effect, EffectInfo, Form, parameter};
use crate::view::{Signal, View};
use jointbench_instrument::Kind;

pub struct TorqueConstantSaturation;

static INFO: EffectInfo = EffectInfo {
    id: "torque_constant_saturation",
    kind: Kind::Friction,
    title: "Saturation of the torque constant",
    sentence: "At high current the iron saturates: the motor gives less torque for each ampere, so it seems to need more.",
    formula: "s·τ³, that is k_m falls by s·τ² at the motor torque τ",
    source: "Hanselman, Brushless Permanent Magnet Motor Design, ch. 4",
    looks: "odd in the motor torque, only at high torque",
    parameters: &[parameter("s", "1/Nm²", 0.0, f64::INFINITY)],
    needs: &[],
};

impl Effect for TorqueConstantSaturation {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, _: &View) -> Vec<Form<'_>> {
        vec![Form::linear(&["s"])]
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        vec![view.map(Signal::Drive, |t| t * t * t)]
    }
}
