//! Samples as columns: one time of the bench is one row of a [`Trace`], from the engine to the store and the model.

use crate::units::unit_of;
use serde::{Deserialize, Serialize};

/// One measured or commanded quantity. The unit is the suffix of the name (`link_torque_nm`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Channel {
    /// Unique in its trace; ends with the unit.
    pub name: String,
    /// The resolution of the instrument in the channel's unit: one count of an encoder or converter. The store keeps
    /// such a channel as whole counts. `None`: the source has no resolution of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resolution: Option<f64>,
}

impl Channel {
    /// A channel without a resolution.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), resolution: None }
    }

    /// A channel of whole multiples of `resolution`, which is in the channel's unit.
    pub fn counted(name: impl Into<String>, resolution: f64) -> Self {
        Self { name: name.into(), resolution: Some(resolution) }
    }

    /// The unit, from the suffix of the name. `None`: a number without unit.
    pub fn unit(&self) -> Option<&'static str> {
        unit_of(&self.name)
    }
}

/// Rows of samples, stored as columns of equal length.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Trace {
    channels: Vec<Channel>,
    columns: Vec<Vec<f64>>,
}

impl Trace {
    /// A trace without rows.
    pub fn new(channels: Vec<Channel>) -> Self {
        let columns = channels.iter().map(|_| Vec::new()).collect();
        Self { channels, columns }
    }

    /// # Panics
    /// If the columns differ from the channels in number, or from each other in length: a programming error, not bad
    /// input.
    pub fn from_columns(channels: Vec<Channel>, columns: Vec<Vec<f64>>) -> Self {
        assert_eq!(channels.len(), columns.len(), "one column for each channel");
        assert!(columns.windows(2).all(|w| w[0].len() == w[1].len()), "columns of equal length");
        Self { channels, columns }
    }

    /// # Panics
    /// If the row and the trace differ in width: a programming error.
    pub fn push_row(&mut self, row: &[f64]) {
        assert_eq!(row.len(), self.columns.len(), "one value for each channel");
        for (column, value) in self.columns.iter_mut().zip(row) {
            column.push(*value);
        }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The channels, in the order of the columns.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The columns in the order of the channels, all of the same length.
    pub fn columns(&self) -> &[Vec<f64>] {
        &self.columns
    }

    /// Position of the channel with this name.
    pub fn index_of(&self, name: &str) -> Option<usize> {
        self.channels.iter().position(|c| c.name == name)
    }

    /// The values of the channel with this name.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.index_of(name).map(|i| self.columns[i].as_slice())
    }

    /// Channels and columns, without a copy. [`Trace::from_columns`] joins them again.
    pub fn into_parts(self) -> (Vec<Channel>, Vec<Vec<f64>>) {
        (self.channels, self.columns)
    }

    /// Removes the rows and keeps an empty trace with the same channels.
    pub fn take(&mut self) -> Trace {
        let empty = Trace::new(self.channels.clone());
        std::mem::replace(self, empty)
    }

    /// Appends the rows of a trace with the same channels.
    ///
    /// # Panics
    /// If the channels differ.
    pub fn append(&mut self, mut other: Trace) {
        assert_eq!(self.channels, other.channels, "the same channels");
        for (column, more) in self.columns.iter_mut().zip(&mut other.columns) {
            column.append(more);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_become_columns() {
        let mut trace = Trace::new(vec![Channel::new("time_s"), Channel::counted("motor_position_rad", 1e-3)]);
        trace.push_row(&[0.0, 1.0]);
        trace.push_row(&[0.1, 2.0]);
        assert_eq!(trace.column("motor_position_rad"), Some(&[1.0, 2.0][..]));
        let taken = trace.take();
        assert_eq!((taken.len(), trace.len()), (2, 0));
        assert_eq!(trace.channels(), taken.channels());
    }
}
