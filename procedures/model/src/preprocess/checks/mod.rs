//! Data checks before the fit: columns and test conditions that contradict each other.

pub(crate) mod blocks;
pub(crate) mod brake_range;
pub(crate) mod metadata;
pub(crate) mod sensor_faults;
pub(crate) mod torque_sign;
pub(crate) mod unit_mismatch;
pub(crate) mod unsigned_current;
