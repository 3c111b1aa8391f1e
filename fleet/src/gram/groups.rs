//! The states of many groups in one vector.

use super::{Rows, length, list, state};
use datafusion::arrow::array::{Array, ArrayRef, AsArray, BooleanArray};
use datafusion::common::Result;
use datafusion::logical_expr::{EmitTo, GroupsAccumulator};
use jointbench_model::linear::moments;

#[derive(Debug)]
pub(super) struct Groups {
    arguments: usize,
    length: usize,
    /// `length` numbers for each group.
    states: Vec<f64>,
}

/// Whether a row passes the filter of the aggregate.
fn passes(filter: Option<&BooleanArray>, row: usize) -> bool {
    filter.is_none_or(|filter| filter.is_valid(row) && filter.value(row))
}

impl Groups {
    pub fn new(arguments: usize) -> Self {
        Self { arguments, length: length(arguments), states: Vec::new() }
    }

    fn of(&mut self, group: usize) -> &mut [f64] {
        &mut self.states[group * self.length..(group + 1) * self.length]
    }

    fn emit(&mut self, emit_to: EmitTo) -> ArrayRef {
        let numbers = match emit_to {
            EmitTo::All => EmitTo::All,
            EmitTo::First(groups) => EmitTo::First(groups * self.length),
        };
        let states = numbers.take_needed(&mut self.states);
        list(states, self.length, |state| state[0] > 0.0)
    }
}

impl GroupsAccumulator for Groups {
    fn update_batch(
        &mut self,
        values: &[ArrayRef],
        group_indices: &[usize],
        filter: Option<&BooleanArray>,
        total_num_groups: usize,
    ) -> Result<()> {
        self.states.resize(total_num_groups * self.length, 0.0);
        let rows = Rows::new(values);
        let mut row = vec![0.0; self.arguments];
        for (at, group) in group_indices.iter().enumerate() {
            if passes(filter, at) && rows.copy(at, &mut row) {
                moments::add_row(self.of(*group), &row);
            }
        }
        Ok(())
    }

    fn merge_batch(&mut self, values: &[ArrayRef], group_indices: &[usize], total_num_groups: usize) -> Result<()> {
        self.states.resize(total_num_groups * self.length, 0.0);
        let states = values[0].as_list::<i32>();
        let (length, arguments) = (self.length, self.arguments);
        for (at, group) in group_indices.iter().enumerate() {
            if let Some(other) = state(states, at, length)? {
                moments::merge(self.of(*group), other, arguments);
            }
        }
        Ok(())
    }

    fn evaluate(&mut self, emit_to: EmitTo) -> Result<ArrayRef> {
        Ok(self.emit(emit_to))
    }

    fn state(&mut self, emit_to: EmitTo) -> Result<Vec<ArrayRef>> {
        Ok(vec![self.emit(emit_to)])
    }

    /// Each row as a state of its own, where grouping before the exchange does not pay.
    fn convert_to_state(&self, values: &[ArrayRef], filter: Option<&BooleanArray>) -> Result<Vec<ArrayRef>> {
        let rows = Rows::new(values);
        let mut states = vec![0.0; rows.len() * self.length];
        let mut row = vec![0.0; self.arguments];
        for (at, state) in states.chunks_exact_mut(self.length).enumerate() {
            if passes(filter, at) && rows.copy(at, &mut row) {
                moments::add_row(state, &row);
            }
        }
        Ok(vec![list(states, self.length, |state| state[0] > 0.0)])
    }

    fn size(&self) -> usize {
        size_of_val(self) + self.states.capacity() * size_of::<f64>()
    }
}
