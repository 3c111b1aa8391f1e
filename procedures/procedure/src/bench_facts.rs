//! Facts about a bench that a procedure may use before anything moves.

use crate::brake_model::{BrakeModel, ComparedBrake};
use crate::plan::PlanFault;
use jointbench_instrument::bench::JointConstants;
use jointbench_instrument::roles::{PositionCounter, SetpointInterval};
use jointbench_instrument::{Bench, Limits};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Facts about a bench that a procedure may use before anything moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BenchFacts {
    /// Name in the bench description.
    pub name: String,
    /// The bench is the mock bench.
    pub simulated: bool,
    /// Limits that the plan has to respect.
    pub limits: Limits,
    /// Constants of the joint and its brake.
    pub constants: JointConstants,
    /// A torque sensor is connected.
    pub has_torque_sensor: bool,
    /// The torque sensor reports every sample in two ranges.
    pub has_two_ranges: bool,
    /// A brake with its supply is connected.
    pub has_brake: bool,
    /// Reference and test encoder: counts in a turn. `None` if one of them is missing.
    pub encoder_counts: Option<[f64; 2]>,
    /// An alignment stage holds the sensor of the encoder under test.
    pub has_stage: bool,
    /// Motor current for each volt, if the joint's servo measures it as the voltage at a shunt.
    pub amperes_per_volt: Option<f64>,
    /// Interpolation of position set-points, if the joint's drive accepts positions.
    pub setpoint_interval: Option<SetpointInterval>,
    /// The brake model of an earlier run, if a procedure needs it ([`crate::Procedure::brake_model`]).
    #[serde(skip)]
    pub brake_model: Option<BrakeModel>,
    /// The brake of another run, if a procedure compares with it ([`crate::Procedure::compared_brake`]).
    #[serde(skip)]
    pub compared_brake: Option<ComparedBrake>,
    /// Whether the joint's drive accepts a motor current in addition to a velocity.
    pub feeds_forward: bool,
}

impl BenchFacts {
    /// The facts of an open bench; without a brake model.
    pub fn of(bench: &Bench) -> Self {
        Self {
            name: bench.name.clone(),
            simulated: bench.simulated,
            limits: bench.limits,
            constants: bench.constants,
            has_torque_sensor: bench.torque_sensor.is_some(),
            has_two_ranges: bench.torque_sensor.as_ref().is_some_and(|sensor| sensor.has_two_ranges()),
            has_brake: bench.brake.is_some(),
            encoder_counts: counts(&bench.reference_encoder)
                .zip(counts(&bench.test_encoder))
                .map(|(reference, test)| [reference, test]),
            has_stage: bench.stage.is_some(),
            amperes_per_volt: bench.joint.amperes_per_volt(),
            setpoint_interval: bench.joint.setpoint_interval(),
            brake_model: None,
            compared_brake: None,
            feeds_forward: bench.joint.feeds_forward(),
        }
    }

    /// An error unless brake and torque sensor are connected.
    pub(crate) fn check_load(&self, cure: &'static str) -> Result<(), PlanFault> {
        for (there, role) in [(self.has_brake, "brake"), (self.has_torque_sensor, "torque sensor")] {
            if !there {
                return Err(self.missing(role, cure));
            }
        }
        Ok(())
    }

    /// The bench has no instrument in this role.
    pub(crate) fn missing(&self, role: &'static str, cure: &'static str) -> PlanFault {
        PlanFault::MissingInstrument { bench: self.name.clone(), role, cure }
    }
}

fn counts(encoder: &Option<Box<dyn PositionCounter>>) -> Option<f64> {
    encoder.as_ref().map(|encoder| TAU / encoder.resolution().0)
}
