//! Units at the interfaces: a newtype for every quantity of a role. Modules use plain `f64` with a unit suffix inside.

use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};
use std::fmt;

macro_rules! unit {
    ($(#[$doc:meta])* $name:ident, $symbol:literal) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default, Serialize, Deserialize)]
        #[serde(transparent)]
        pub struct $name(pub f64);

        impl $name {
            /// The symbol of the unit.
            pub const SYMBOL: &'static str = $symbol;
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                if let Some(digits) = f.precision() {
                    write!(f, "{:.*} {}", digits, self.0, $symbol)
                } else {
                    write!(f, "{} {}", self.0, $symbol)
                }
            }
        }
    };
}

unit!(/// Angle.
    Radians, "rad");
unit!(/// Angular velocity.
    RadPerSec, "rad/s");
unit!(/// Torque.
    NewtonMetres, "Nm");
unit!(/// Electric current.
    Amperes, "A");
unit!(/// Electric potential.
    Volts, "V");
unit!(/// Temperature.
    Celsius, "°C");
unit!(/// Duration, or a moment on the bench's clock.
    Seconds, "s");
unit!(/// Power.
    Watts, "W");

/// The same angle within half a turn of zero, −π ≤ θ < π.
pub fn wrapped(angle_rad: f64) -> f64 {
    (angle_rad + PI).rem_euclid(TAU) - PI
}

/// The unit of a column or channel name by its suffix (`motor_velocity_rad_s` → `rad/s`), in SI symbols.
///
/// `None` for names without a unit suffix (`segment`, `repeat`, `kp`).
pub fn unit_of(name: &str) -> Option<&'static str> {
    SUFFIXES.iter().find(|(suffix, _)| name.ends_with(suffix)).map(|(_, unit)| *unit)
}

/// A name without the suffix of its unit.
pub fn quantity_of(name: &str) -> Option<&str> {
    SUFFIXES.iter().find_map(|(suffix, _)| name.strip_suffix(suffix))
}

/// Longer suffixes first: `_rad_s` before `_s`, `_nm_per_a` before `_a`.
const SUFFIXES: [(&str, &str); 19] = [
    ("_nm_per_rad", "Nm/rad"),
    ("_nm_rad", "Nm/rad"),
    ("_nm_s", "Nm·s/rad"),
    ("_nm_per_a", "Nm/A"),
    ("_kg_m2", "kg·m²"),
    ("_rad_s2", "rad/s²"),
    ("_rad_s", "rad/s"),
    ("_rad", "rad"),
    ("_nm", "Nm"),
    ("_ms", "ms"),
    ("_hz", "Hz"),
    ("_c", "°C"),
    ("_a", "A"),
    ("_pa", "Pa"),
    ("_percent", "%"),
    ("_v", "V"),
    ("_w", "W"),
    ("_m", "m"),
    ("_s", "s"),
];

/// The same unit on a linear axis (`"motion": "linear"` in the meta file): rad → m, Nm → N, kg·m² → kg.
pub(crate) fn linear_unit(unit: &str) -> String {
    unit.replace("kg·m²", "kg").replace("Nm", "N").replace("rad", "m")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suffixes_name_their_unit() {
        for (name, unit) in [
            ("time_s", Some("s")),
            ("motor_position_rad", Some("rad")),
            ("motor_velocity_rad_s", Some("rad/s")),
            ("link_torque_nm", Some("Nm")),
            ("temperature_c", Some("°C")),
            ("motor_current_a", Some("A")),
            ("torque_constant_nm_per_a", Some("Nm/A")),
            ("segment", None),
        ] {
            assert_eq!(unit_of(name), unit, "{name}");
        }
    }

    #[test]
    fn an_angle_is_wrapped_to_the_nearest_turn() {
        for (angle, nearest) in [(0.1, 0.1), (TAU - 0.1, -0.1), (-TAU - 0.2, -0.2), (17.0 * TAU + 3.0, 3.0)] {
            assert!((wrapped(angle) - nearest).abs() < 1e-9, "{angle}");
        }
    }

    #[test]
    fn linear_motion_changes_every_label() {
        assert_eq!(linear_unit("Nm·s/rad"), "N·s/m");
        assert_eq!(linear_unit("kg·m²"), "kg");
    }

    #[test]
    fn a_quantity_prints_with_its_unit() {
        assert_eq!(format!("{:.2}", NewtonMetres(0.0306)), "0.03 Nm");
    }
}
