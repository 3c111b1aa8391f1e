//! `regressor(effect, velocity)`: the column of an effect of the library as a function of SQL.

use datafusion::arrow::array::{Array, ArrayRef, AsArray, Float64Array};
use datafusion::arrow::datatypes::{DataType, Float64Type};
use datafusion::common::{Result, ScalarValue, exec_err, plan_err};
use datafusion::logical_expr::{
    ColumnarValue, ScalarFunctionArgs, ScalarUDF, ScalarUDFImpl, Signature, TypeSignature, Volatility,
};
use jointbench_instrument::Kind;
use jointbench_model::effects;
use jointbench_model::signal::{Signal, Signals};
use jointbench_model::view::View;
use std::sync::Arc;

/// Effects with one column that depends only on the velocity of the same row. A test compares each with a fit of the
/// daemon.
pub const ROW_WISE: [&str; 4] = ["coulomb", "viscous", "direction_offset", "viscous_asymmetry"];

/// The function for [`datafusion::prelude::SessionContext::register_udf`]: effect id (text) and velocity \[rad/s\].
pub fn regressor() -> ScalarUDF {
    ScalarUDF::from(Regressor { signature: Signature::new(TypeSignature::UserDefined, Volatility::Immutable) })
}

#[derive(Debug, PartialEq, Eq, Hash)]
struct Regressor {
    signature: Signature,
}

impl ScalarUDFImpl for Regressor {
    fn name(&self) -> &str {
        "regressor"
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn coerce_types(&self, arguments: &[DataType]) -> Result<Vec<DataType>> {
        match arguments.len() {
            2 => Ok(vec![DataType::Utf8, DataType::Float64]),
            _ => plan_err!("regressor('EFFECT', velocity) has two arguments"),
        }
    }

    fn return_type(&self, _: &[DataType]) -> Result<DataType> {
        Ok(DataType::Float64)
    }

    fn invoke_with_args(&self, arguments: ScalarFunctionArgs) -> Result<ColumnarValue> {
        let [ColumnarValue::Scalar(ScalarValue::Utf8(Some(effect))), velocity] = &arguments.args[..] else {
            return exec_err!("regressor('EFFECT', velocity): the effect is a text in quotes");
        };
        if !ROW_WISE.contains(&effect.as_str()) {
            return exec_err!("regressor: {effect} needs more than the velocity; expected {}", ROW_WISE.join(", "));
        }
        let velocity = velocity.to_array(arguments.number_rows)?;
        Ok(ColumnarValue::Array(column(effect, &velocity)?))
    }
}

/// The column of an effect; absent where the velocity is.
fn column(effect: &str, velocity: &ArrayRef) -> Result<ArrayRef> {
    let velocity = velocity.as_primitive::<Float64Type>();
    let mut signals = Signals::new(velocity.len());
    signals.set(Signal::Velocity, velocity.values().to_vec());
    signals.set(Signal::Direction, velocity.values().iter().map(|v| v.signum()).collect());
    let view = View::new(signals, Signals::default(), Vec::new(), Vec::new(), 1.0);
    match effects::find(Kind::Friction, effect).map(|effect| effect.columns("linear", &[], &view)) {
        Ok(columns) if columns.len() == 1 => {
            let values = columns.into_iter().flatten().collect::<Vec<f64>>();
            Ok(Arc::new(Float64Array::new(values.into(), velocity.nulls().cloned())))
        }
        _ => exec_err!("regressor: {effect} is no effect with one column"),
    }
}
