//! `gram(y, x1, x2, …)`: the Gram matrix of a least-squares problem as an aggregate function of SQL.
//!
//! The result is a list of doubles, the state of `jointbench_model::linear::moments` with the columns in the order of
//! the arguments: number of rows, means, and the lower triangle of the centred sums of products (Chan, Golub, LeVeque
//! 1983). Rows with an absent value are omitted. States of different rows can be merged, so that partial results of
//! threads, files and machines give the Gram matrix of all rows.

mod accumulator;
mod groups;
mod regressor;

pub use regressor::{ROW_WISE, regressor};

use accumulator::Single;
use datafusion::arrow::array::{Array, ArrayRef, AsArray, Float64Array, ListArray};
use datafusion::arrow::buffer::{NullBuffer, OffsetBuffer, ScalarBuffer};
use datafusion::arrow::datatypes::{DataType, Field, FieldRef, Float64Type};
use datafusion::common::{Result, exec_err, plan_err};
use datafusion::logical_expr::function::{AccumulatorArgs, StateFieldsArgs};
use datafusion::logical_expr::{
    Accumulator, AggregateUDF, AggregateUDFImpl, GroupsAccumulator, Signature, TypeSignature, Volatility,
};
use groups::Groups;
use jointbench_model::linear::moments;
use std::sync::Arc;

/// Name of the function in SQL.
pub const NAME: &str = "gram";

/// The aggregate function for [`datafusion::prelude::SessionContext::register_udaf`].
pub fn gram() -> AggregateUDF {
    AggregateUDF::from(Gram { signature: Signature::new(TypeSignature::UserDefined, Volatility::Immutable) })
}

#[derive(Debug, PartialEq, Eq, Hash)]
struct Gram {
    signature: Signature,
}

impl AggregateUDFImpl for Gram {
    fn name(&self) -> &str {
        NAME
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn coerce_types(&self, arguments: &[DataType]) -> Result<Vec<DataType>> {
        if arguments.len() < 2 {
            return plan_err!("gram(y, x1, …) needs a response and at least one regressor");
        }
        match arguments.iter().find(|of| !of.is_numeric() && **of != DataType::Null) {
            Some(other) => plan_err!("gram(y, x1, …) takes numbers, not {other}"),
            None => Ok(vec![DataType::Float64; arguments.len()]),
        }
    }

    fn return_type(&self, _: &[DataType]) -> Result<DataType> {
        Ok(state_type())
    }

    fn state_fields(&self, arguments: StateFieldsArgs) -> Result<Vec<FieldRef>> {
        Ok(vec![Arc::new(Field::new(format!("{}[state]", arguments.name), state_type(), true))])
    }

    fn accumulator(&self, arguments: AccumulatorArgs) -> Result<Box<dyn Accumulator>> {
        Ok(Box::new(Single::new(arguments.exprs.len())))
    }

    fn groups_accumulator_supported(&self, _: AccumulatorArgs) -> bool {
        true
    }

    fn create_groups_accumulator(&self, arguments: AccumulatorArgs) -> Result<Box<dyn GroupsAccumulator>> {
        Ok(Box::new(Groups::new(arguments.exprs.len())))
    }
}

fn item() -> FieldRef {
    Arc::new(Field::new("item", DataType::Float64, true))
}

fn state_type() -> DataType {
    DataType::List(item())
}

/// States of `length` numbers each as a list array. `is_present` is false for a state without rows.
fn list(states: Vec<f64>, length: usize, is_present: impl Fn(&[f64]) -> bool) -> ArrayRef {
    let present: Vec<bool> = states.chunks_exact(length).map(is_present).collect();
    let offsets: Vec<i32> = (0..=present.len()).map(|at| (at * length) as i32).collect();
    let offsets = OffsetBuffer::new(ScalarBuffer::from(offsets));
    let nulls = NullBuffer::from(present);
    Arc::new(ListArray::new(item(), offsets, Arc::new(Float64Array::from(states)), Some(nulls)))
}

/// The state in a row of a list array. `None` for a group without rows.
///
/// # Errors
/// If the list has another length.
fn state(states: &ListArray, row: usize, length: usize) -> Result<Option<&[f64]>> {
    if states.is_null(row) {
        return Ok(None);
    }
    let offsets = states.value_offsets();
    let range = offsets[row] as usize..offsets[row + 1] as usize;
    if range.len() != length {
        return exec_err!("a state of gram has {} numbers instead of {length}", range.len());
    }
    Ok(Some(&states.values().as_primitive::<Float64Type>().values()[range]))
}

/// The arguments of a batch as columns, and the rows in which each has a value.
struct Rows<'a> {
    columns: Vec<&'a [f64]>,
    nulls: Option<NullBuffer>,
}

impl<'a> Rows<'a> {
    fn new(values: &'a [ArrayRef]) -> Self {
        let nulls =
            values.iter().fold(None, |all: Option<NullBuffer>, column| NullBuffer::union(all.as_ref(), column.nulls()));
        let columns = values.iter().map(|column| &column.as_primitive::<Float64Type>().values()[..]).collect();
        Self { columns, nulls }
    }

    fn len(&self) -> usize {
        self.columns.first().map_or(0, |column| column.len())
    }

    /// Copies a row. `false` if one of its values is absent.
    fn copy(&self, row: usize, into: &mut [f64]) -> bool {
        if self.nulls.as_ref().is_some_and(|nulls| nulls.is_null(row)) {
            return false;
        }
        self.columns.iter().zip(into).for_each(|(column, value)| *value = column[row]);
        true
    }
}

/// Numbers in the state of a call with `arguments` arguments.
fn length(arguments: usize) -> usize {
    moments::length(arguments)
}
