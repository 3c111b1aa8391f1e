//! Saturation of the torque constant.

use crate::effect::{Columns, Effect, EffectInfo, Form, Shape, ShapeSearch, Traits, parameter};
use crate::effects::magnitudes;
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic, formula};
use crate::thresholds::CURVE_RANGE;
use crate::view::View;
use jointbench_instrument::Kind;
use std::iter;

pub struct TorqueConstantSaturation;

/// Below the lower limit it looks like load-dependent friction, above the upper one like a stop.
const LEAST_POWER: f64 = 2.0;
const LARGEST_POWER: f64 = 4.0;

static INFO: EffectInfo = EffectInfo {
    id: "torque_constant_saturation",
    kind: Kind::Friction,
    title: "Saturation of the torque constant",
    sentence: "At high current the iron saturates: the torque constant decreases, so k_m·i_q overestimates the torque.",
    formula: "s·τ³, that is k_m falls by s·τ² at the motor torque τ; or s_n·|τ|ⁿ·τ for a sharper or softer saturation",
    source: "Hanselman 2003, ch. 4",
    looks: "odd in the motor torque, only at high torque",
    parameters: &[
        parameter("s", "1/Nm²", 0.0, f64::INFINITY),
        parameter("s_n", "1/Nmⁿ", 0.0, f64::INFINITY),
        parameter("n", "1", LEAST_POWER, LARGEST_POWER),
    ],
    needs: &[],
};

impl Effect for TorqueConstantSaturation {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn traits(&self) -> Traits {
        Traits {
            excitation: Some("larger and smaller motor torques"),
            unseen: Some("the motor torque hardly changes; measure larger and smaller motor torques"),
            ..Traits::default()
        }
    }

    /// The power is not visible without a load: then the torque follows the speed, and any power of it is only another
    /// curve over speed. Over a small range of torques, no curve differs from a straight line.
    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        if magnitudes(view, Signal::Drive).is_none_or(|(low, high)| high < CURVE_RANGE * low) {
            return Vec::new();
        }
        let shape = vec![Shape { name: "n", min: LEAST_POWER, max: LARGEST_POWER, search: ShapeSearch::Smooth }];
        let grid = vec![vec![3.0]];
        let power = Form { name: "power", linear: vec!["s_n"], shape, grid };
        iter::once(Form::linear(&["s"])).chain(view.bears_load().then_some(power)).collect()
    }

    fn columns(&self, form: &str, shape: &[f64], view: &View) -> Columns {
        vec![match form {
            "power" => view.map(Signal::Drive, |t| t.abs().powf(shape[0]) * t),
            _ => view.map(Signal::Drive, |t| t * t * t),
        }]
    }

    fn symbolic(&self, form: &FittedForm) -> Symbolic {
        match form.name {
            "power" => formula("abs(motor_torque) ^ n * motor_torque"),
            _ => formula("motor_torque * motor_torque * motor_torque"),
        }
    }
}
