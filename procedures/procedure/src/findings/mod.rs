//! Shared functions of identifications: parts of a run, steady-state means, straight lines, small least squares,
//! parameters as quantities.

mod holds;
mod lag;
mod legs;
mod line;
mod plateaus;
mod quantities;
mod series;
mod solve;
mod unusable;

pub(crate) use holds::{Hold, holds};
pub(crate) use lag::{Lag, ReadingPair, lag};
pub(crate) use legs::{Leg, legs, select_legs, select_rows};
pub(crate) use line::{Line, Mean};
pub(crate) use plateaus::{Plateau, plateaus, settled};
pub(crate) use quantities::{bounded, combined, directions, interval_of, parameter, percentage, quantity};
pub(crate) use series::{curve, scatter};
pub(crate) use solve::{Solved, jackknife95, solve, spread_ci95, t95};
pub(crate) use unusable::{Unusable, verdict};
