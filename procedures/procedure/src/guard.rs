//! The guard: it checks every command and every sample of the engine.

mod torsion;

use jointbench_instrument::bench::JointConstants;
use jointbench_instrument::limits::Limited;
use jointbench_instrument::{Breach, Limits, TorsionLimit};
use std::collections::VecDeque;
use std::f64::consts::TAU;
use torsion::TorsionWatch;

/// Ratio of trip to set limit for a measured current or speed, so that noise at the set limit does not trip: 0.62 A
/// over 0.60 A (Magtrol 2025).
const TRIP_OVER_SET: f64 = 0.62 / 0.60;
/// Ratio of peak to continuous power of the brake: 1200 W over 350 W (HB-1750M, Magtrol 2025).
const PEAK_OVER_CONTINUOUS: f64 = 1200.0 / 350.0;
/// Averaging time of the continuous power.
const POWER_WINDOW_S: f64 = 10.0;
/// Below this link speed a falling brake current leaves poles in the rotor: 1 rpm.
pub const STANDSTILL_LINK_RAD_S: f64 = TAU / 60.0;
/// Largest share by which the brake current may fall at standstill.
const STANDSTILL_DECREASE: f64 = 0.2;

/// Why the guard ends a run.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// A command or a sample exceeds a limit of the bench.
    #[error(transparent)]
    Breach(#[from] Breach),
    /// The brake current would fall too far while the shaft stands still.
    #[error(
        "brake current from {from_a:.3} A to {to_a:.3} A at standstill would magnetise the rotor (cogging): turn the \
         shaft first"
    )]
    BrakeAtStandstill {
        /// Present brake current.
        from_a: f64,
        /// Commanded brake current.
        to_a: f64,
    },
    /// The link is, or would be, outside its permitted range.
    #[error(
        "link position {position_rad:.3} rad is beyond the range of ±{range_rad:.3} rad: move the joint back manually \
         or with the tool of the drive"
    )]
    BeyondRange {
        /// Position of the link.
        position_rad: f64,
        /// Permitted rotation to either side of the encoder's zero.
        range_rad: f64,
    },
    /// The torsion of the joint is not the one that its torque causes.
    #[error(
        "the torsion of the joint has changed by {:.3} mrad, but its torque by {torque_nm:.3} Nm, which causes {:.3} \
         mrad; tolerance {:.3} mrad: check the coupling, the gear and both encoders of the joint",
        1e3 * .torsion_rad, 1e3 * .expected_rad, 1e3 * .tolerance_rad
    )]
    Torsion {
        /// Change of the torsion between both encoders since the start of the run, link side.
        torsion_rad: f64,
        /// Change that the torque causes by the compliance of the joint.
        expected_rad: f64,
        /// Change of the torque since the start of the run.
        torque_nm: f64,
        /// Largest permitted deviation.
        tolerance_rad: f64,
    },
}

/// Checked quantities of one tick. Unmeasured quantities are `None`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// On the bench's clock.
    pub at_s: f64,
    /// Angular velocity of the motor.
    pub motor_velocity_rad_s: f64,
    /// Torque-producing motor current.
    pub motor_current_a: f64,
    /// Link position from its encoder, otherwise from that of the motor.
    pub link_position_rad: f64,
    /// Torsion between motor and link, link side, if the link has an encoder.
    pub torsion_rad: Option<f64>,
    /// Torque between joint and load.
    pub link_torque_nm: Option<f64>,
    /// Temperature of the joint.
    pub temperature_c: Option<f64>,
    /// Measured current of the brake.
    pub brake_current_a: Option<f64>,
}

/// Checks one run.
#[derive(Debug, Clone)]
pub struct Guard {
    limits: Limits,
    constants: JointConstants,
    torsion: Option<TorsionWatch>,
    power: Power,
    link_speed_rad_s: f64,
    brake_a: f64,
    /// Largest brake current since the link last turned, which determines the magnetisation of its poles.
    magnetised_a: f64,
}

impl Guard {
    /// A guard with these limits. The constants relate motor and link and bound the travel of the link.
    pub fn new(limits: Limits, torsion: Option<TorsionLimit>, constants: JointConstants) -> Self {
        let power = Power { samples: VecDeque::new(), energy_j: 0.0, last_s: None };
        let torsion = torsion.map(TorsionWatch::new);
        Self { limits, constants, torsion, power, link_speed_rad_s: 0.0, brake_a: 0.0, magnetised_a: 0.0 }
    }

    /// Called before a velocity set-point is sent.
    pub fn check_velocity(&self, motor_velocity_rad_s: f64) -> Result<(), Refusal> {
        Ok(self.limits.check(Limited::MotorVelocity, motor_velocity_rad_s)?)
    }

    /// Called before a motor current is sent, alone or as feedforward.
    pub fn check_motor_current(&self, current_a: f64) -> Result<(), Refusal> {
        Ok(self.limits.check(Limited::MotorCurrent, current_a)?)
    }

    /// Called before a brake current is sent.
    pub fn check_brake(&mut self, to_a: f64) -> Result<(), Refusal> {
        self.limits.check(Limited::BrakeCurrent, to_a)?;
        if !self.is_turning() && to_a < (1.0 - STANDSTILL_DECREASE) * self.magnetised_a {
            return Err(Refusal::BrakeAtStandstill { from_a: self.magnetised_a, to_a });
        }
        self.brake_follows(to_a);
        Ok(())
    }

    /// Called before a brake current is sent that may fall at standstill, because its step magnetises the rotor.
    pub fn check_magnetising_brake(&mut self, to_a: f64) -> Result<(), Refusal> {
        self.limits.check(Limited::BrakeCurrent, to_a)?;
        self.brake_follows(to_a);
        Ok(())
    }

    fn brake_follows(&mut self, to_a: f64) {
        self.brake_a = to_a;
        self.magnetised_a = if self.is_turning() { to_a } else { self.magnetised_a.max(to_a) };
    }

    /// Called with every sample.
    pub fn check_sample(&mut self, sample: &Sample) -> Result<(), Refusal> {
        self.check_trip(Limited::MotorVelocity, sample.motor_velocity_rad_s, TRIP_OVER_SET)?;
        self.check_trip(Limited::MotorCurrent, sample.motor_current_a, 1.0)?;
        if let Some(torque_nm) = sample.link_torque_nm {
            self.check_trip(Limited::LinkTorque, torque_nm, 1.0)?;
        }
        if let Some(temperature_c) = sample.temperature_c {
            self.check_trip(Limited::Temperature, temperature_c, 1.0)?;
        }
        if let Some(current_a) = sample.brake_current_a {
            self.check_trip(Limited::BrakeCurrent, current_a, TRIP_OVER_SET)?;
        }
        if let Some(range_rad) = self.constants.link_range_rad {
            let position_rad = sample.link_position_rad;
            // A position of NaN violates the range, too.
            let inside = position_rad.abs() <= range_rad;
            if !inside {
                return Err(Refusal::BeyondRange { position_rad, range_rad });
            }
        }
        if let (Some(watch), Some(torsion_rad), Some(torque_nm)) =
            (&mut self.torsion, sample.torsion_rad, sample.link_torque_nm)
        {
            watch.check(torsion_rad, torque_nm)?;
        }
        self.link_speed_rad_s = sample.motor_velocity_rad_s / self.constants.gear_ratio;
        if self.is_turning() {
            self.magnetised_a = self.brake_a;
        }
        if let Some(torque_nm) = sample.link_torque_nm {
            let power_w = (torque_nm * self.link_speed_rad_s).abs();
            self.check_trip(Limited::BrakePower, power_w, PEAK_OVER_CONTINUOUS)?;
            let average_w = self.power.average_w(sample.at_s, power_w);
            self.check_trip(Limited::BrakePower, average_w, 1.0)?;
        }
        Ok(())
    }

    fn is_turning(&self) -> bool {
        self.link_speed_rad_s.abs() >= STANDSTILL_LINK_RAD_S
    }

    fn check_trip(&self, quantity: Limited, value: f64, margin: f64) -> Result<(), Breach> {
        let limit = margin * self.limits.of(quantity);
        if value.abs() <= limit { Ok(()) } else { Err(Breach { quantity, value, limit }) }
    }
}

/// The mean power of the last ten seconds; the time before the start counts as zero.
#[derive(Debug, Clone)]
struct Power {
    /// Time, and energy since the previous sample.
    samples: VecDeque<(f64, f64)>,
    energy_j: f64,
    last_s: Option<f64>,
}

impl Power {
    fn average_w(&mut self, at_s: f64, power_w: f64) -> f64 {
        let energy_j = power_w * (at_s - self.last_s.unwrap_or(at_s));
        self.last_s = Some(at_s);
        self.samples.push_back((at_s, energy_j));
        self.energy_j += energy_j;
        while let Some((_, old_j)) = self.samples.pop_front_if(|(then_s, _)| *then_s < at_s - POWER_WINDOW_S) {
            self.energy_j -= old_j;
        }
        self.energy_j / POWER_WINDOW_S
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits {
        motor_velocity_rad_s: 200.0,
        motor_current_a: 5.0,
        link_torque_nm: 18.0,
        temperature_c: 70.0,
        brake_current_a: 0.6,
        brake_power_w: 350.0,
    };
    const CONSTANTS: JointConstants = JointConstants {
        torque_constant_nm_per_a: 0.08,
        gear_ratio: 2.0,
        rotor_inertia_kg_m2: 1e-5,
        brake_compliance_v: 45.0,
        brake_rated_current_a: 0.6,
        brake_rated_torque_nm: 13.0,
        link_range_rad: Some(30.0),
        load_gear_ratio: None,
    };
    const QUIET: Sample = Sample {
        at_s: 0.0,
        motor_velocity_rad_s: 0.0,
        motor_current_a: 0.0,
        link_position_rad: 0.0,
        torsion_rad: Some(0.0),
        link_torque_nm: Some(0.0),
        temperature_c: Some(25.0),
        brake_current_a: Some(0.0),
    };

    fn guard() -> Guard {
        Guard::new(LIMITS, None, CONSTANTS)
    }

    fn turning(guard: &mut Guard, motor_velocity_rad_s: f64) {
        guard.check_sample(&Sample { motor_velocity_rad_s, ..QUIET }).unwrap();
    }

    #[test]
    fn every_quantity_trips_on_both_sides_and_on_nan() {
        type Set = fn(&mut Sample, f64);
        let quantities: [(Set, f64); 6] = [
            (|s, v| s.motor_velocity_rad_s = v, 200.0 * TRIP_OVER_SET),
            (|s, v| s.motor_current_a = v, 5.0),
            (|s, v| s.link_torque_nm = Some(v), 18.0),
            (|s, v| s.temperature_c = Some(v), 70.0),
            (|s, v| s.brake_current_a = Some(v), 0.6 * TRIP_OVER_SET),
            (|s, v| s.link_position_rad = v, 30.0),
        ];
        for (set, limit) in quantities {
            for (value, passes) in [
                (0.999 * limit, true),
                (-0.999 * limit, true),
                (1.001 * limit, false),
                (-1.001 * limit, false),
                (f64::NAN, false),
            ] {
                let mut sample = QUIET;
                set(&mut sample, value);
                assert_eq!(guard().check_sample(&sample).is_ok(), passes, "{sample:?}");
            }
        }
    }

    #[test]
    fn commands_are_held_to_the_set_limit() {
        assert!(guard().check_velocity(-200.0).is_ok());
        assert!(guard().check_velocity(200.1).is_err());
        assert!(guard().check_velocity(f64::NAN).is_err());
        assert!(guard().check_brake(0.61).is_err());
        assert!(guard().check_brake(f64::NAN).is_err());
    }

    #[test]
    fn a_magnetising_brake_falls_at_standstill_within_its_limit() {
        let mut guard = guard();
        assert!(guard.check_magnetising_brake(0.61).is_err());
        assert!(guard.check_magnetising_brake(0.5).is_ok() && guard.check_magnetising_brake(0.0).is_ok());
        assert!(guard.check_brake(0.1).is_err(), "other steps remain protected");
    }

    /// Torque and link speed give 17.5 Nm · 40 rad/s = 700 W: twice the continuous rating, allowed for five seconds.
    #[test]
    fn the_power_hyperbola_trips_on_its_average() {
        let mut guard = guard();
        let hot = Sample { motor_velocity_rad_s: 80.0, link_torque_nm: Some(17.5), ..QUIET };
        let tripped_s = (0..4000)
            .map(|tick| f64::from(tick) * 0.004)
            .find(|at_s| guard.check_sample(&Sample { at_s: *at_s, ..hot }).is_err());
        assert!(tripped_s.is_some_and(|s| (s - 5.0).abs() < 0.02), "{tripped_s:?}");
    }

    #[test]
    fn a_power_peak_trips_at_once() {
        let strong = Limits { link_torque_nm: 100.0, ..LIMITS };
        let peak = Sample { motor_velocity_rad_s: 190.0, link_torque_nm: Some(12.7), ..QUIET };
        let refused = Guard::new(strong, None, CONSTANTS).check_sample(&peak).unwrap_err();
        assert!(matches!(refused, Refusal::Breach(Breach { quantity: Limited::BrakePower, .. })), "{refused}");
    }

    #[test]
    fn a_brake_falls_only_while_the_shaft_turns() {
        let mut guard = guard();
        assert!(guard.check_brake(0.5).is_ok());
        assert!(guard.check_brake(0.41).is_ok(), "within 20 %");
        let refused = guard.check_brake(0.39).unwrap_err();
        assert_eq!(refused, Refusal::BrakeAtStandstill { from_a: 0.5, to_a: 0.39 }, "small steps do not add up unseen");
        turning(&mut guard, 2.0);
        assert!(guard.check_brake(0.1).is_ok());
        turning(&mut guard, 0.1);
        assert!(guard.check_brake(0.09).is_ok(), "what was magnetised before turning is forgotten");
    }
}
