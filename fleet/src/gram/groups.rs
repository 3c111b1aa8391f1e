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

#[cfg(test)]
mod tests {
    use super::*;
    use datafusion::arrow::array::Float64Array;
    use datafusion::arrow::datatypes::Float64Type;
    use std::sync::Arc;

    /// Three columns with an absent value in row 4.
    fn columns(rows: usize) -> Vec<ArrayRef> {
        let value = |k: usize, i: usize| (k != 1 || i != 4).then(|| (0.7 * (i + 3 * k) as f64).sin() + k as f64);
        let column = |k: usize| Arc::new((0..rows).map(|i| value(k, i)).collect::<Float64Array>()) as ArrayRef;
        (0..3).map(column).collect()
    }

    fn numbers(array: &ArrayRef) -> Vec<Option<Vec<f64>>> {
        let states = array.as_list::<i32>();
        let of = |row: usize| states.value(row).as_primitive::<Float64Type>().values().to_vec();
        (0..states.len()).map(|row| states.is_valid(row).then(|| of(row))).collect()
    }

    #[test]
    fn rows_as_states_merge_to_the_states_of_the_groups() {
        let columns = columns(30);
        let groups: Vec<usize> = (0..30).map(|i| i % 4).collect();
        let filter: BooleanArray = (0..30).map(|i| Some(i % 4 != 3)).collect();
        let mut whole = Groups::new(3);
        whole.update_batch(&columns, &groups, Some(&filter), 4).unwrap();
        let states = whole.convert_to_state(&columns, Some(&filter)).unwrap();
        let mut merged = Groups::new(3);
        merged.merge_batch(&states, &groups, 4).unwrap();
        let first = numbers(&whole.emit(EmitTo::First(3)));
        let found = numbers(&merged.evaluate(EmitTo::All).unwrap());
        assert_eq!((first.len(), numbers(&whole.emit(EmitTo::All))), (3, vec![None]), "group 3 has no row");
        assert_eq!(found[3], None);
        // Rows 0, 4, …, 28 are group 0; one of them has an absent value.
        assert_eq!(first[0].as_ref().map(|state| state[0]), Some(7.0));
        for (a, b) in first.iter().zip(&found).flat_map(|(a, b)| a.iter().flatten().zip(b.iter().flatten())) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
    }
}
