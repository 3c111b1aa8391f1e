//! Shared functions of identifications: parts of a run, steady-state means, straight lines, small least squares,
//! parameters as quantities.

mod holds;
mod lag;
mod legs;
mod line;
mod plateaus;
mod quantities;
mod solve;

pub(crate) use holds::{Hold, holds};
pub(crate) use lag::{Lag, ReadingPair, lag};
pub(crate) use legs::{Leg, legs, select_legs, select_rows};
pub(crate) use line::{Line, Mean};
pub(crate) use plateaus::{Plateau, plateaus, settled};
pub(crate) use quantities::{
    Unusable, bounded, combined, curve, directions, interval_of, parameter, quantity, scatter, verdict,
};
pub(crate) use solve::{Solved, jackknife95, solve, spread_ci95, t95};
