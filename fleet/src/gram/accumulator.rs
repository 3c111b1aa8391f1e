//! The state of one group: for queries without `GROUP BY`, and for window functions.

use super::{Rows, length, list, state};
use datafusion::arrow::array::{Array, ArrayRef, AsArray};
use datafusion::common::{Result, ScalarValue};
use datafusion::logical_expr::Accumulator;
use jointbench_model::linear::moments;
use std::sync::Arc;

#[derive(Debug)]
pub(super) struct Single {
    arguments: usize,
    state: Vec<f64>,
}

impl Single {
    pub fn new(arguments: usize) -> Self {
        Self { arguments, state: vec![0.0; length(arguments)] }
    }

    fn value(&self) -> ScalarValue {
        let states = list(self.state.clone(), self.state.len(), |state| state[0] > 0.0);
        ScalarValue::List(Arc::new(states.as_list::<i32>().clone()))
    }
}

impl Accumulator for Single {
    fn update_batch(&mut self, values: &[ArrayRef]) -> Result<()> {
        let rows = Rows::new(values);
        let mut row = vec![0.0; self.arguments];
        for at in 0..rows.len() {
            if rows.copy(at, &mut row) {
                moments::add_row(&mut self.state, &row);
            }
        }
        Ok(())
    }

    fn merge_batch(&mut self, states: &[ArrayRef]) -> Result<()> {
        let states = states[0].as_list::<i32>();
        for row in 0..states.len() {
            if let Some(other) = state(states, row, self.state.len())? {
                moments::merge(&mut self.state, other, self.arguments);
            }
        }
        Ok(())
    }

    fn state(&mut self) -> Result<Vec<ScalarValue>> {
        Ok(vec![self.value()])
    }

    fn evaluate(&mut self) -> Result<ScalarValue> {
        Ok(self.value())
    }

    fn size(&self) -> usize {
        size_of_val(self) + self.state.capacity() * size_of::<f64>()
    }
}
