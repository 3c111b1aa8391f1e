//! Shared functions of identifications: parts of a run, steady-state means, straight lines, small least squares,
//! parameters as quantities.

mod holds;
mod lag;
mod line;
mod part;
mod plateaus;
mod say;
mod solve;

pub(crate) use holds::{Hold, holds};
pub(crate) use lag::{Lag, ReadingPair, lag};
pub(crate) use line::{Line, Mean};
pub(crate) use part::{Leg, keep, keep_rows, legs};
pub(crate) use plateaus::{Plateau, plateaus, settled};
pub(crate) use say::{Unusable, combined, curve, interval_of, parameter, quantity, scatter, verdict};
pub(crate) use solve::{solve, t95};
