//! Names of columns that are written and read in several modules.

/// Only for a plan that commands motor current; the rest of such a plan may have none.
pub(crate) const MOTOR_CURRENT_SETPOINT: &str = "motor_current_setpoint_a";

/// The torque in the sensor's other range.
pub(crate) const OTHER_RANGE: &str = "other_range_torque_nm";

/// Names of the pose's columns: shifts (m), then rotations about the same axes (rad).
pub(crate) const POSE: [&str; 6] =
    ["stage_radial_m", "stage_vertical_m", "stage_axial_m", "stage_tilt_rad", "stage_nod_rad", "stage_rotation_rad"];
