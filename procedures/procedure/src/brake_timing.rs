//! Times of a change of the brake current.

/// Ramp of a rising current (chosen).
pub(crate) const RAISE_S: f64 = 0.8;
/// Time until the current has followed: delay of the supply (118 ms, data sheet of the DP800) and of the coil (80 ms,
/// assumed).
pub(crate) const LAG_S: f64 = 0.6;
/// Least duration of a fall, which also takes a whole link turn, so that every pole is reached.
pub(crate) const UNLOAD_S: f64 = 2.0;
