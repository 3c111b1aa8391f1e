//! A plan of a procedure: a list of steps with their set-points over time. Pure data; the engine performs it.

use crate::deferred_plan::DeferredPlan;
use crate::profile::Profile;
use crate::stage_pose::StagePose;
use crate::steady::SteadyCriterion;
use jointbench_instrument::{Kind, Meta};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// The part of a plan that a step belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// Skipped as soon as the joint is steady ([`Plan::steady`]).
    WarmUp,
    /// Its rows belong to the result.
    Measure,
}

/// The history that a step requires. A pause destroys it, and resuming restores it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum InitialState {
    /// The brake in the state after the previous step: a pause keeps its current, and a larger one is approached from
    /// below.
    #[default]
    AsLeft,
    /// The brake demagnetised during rotation, its current 0.
    Demagnetised,
    /// The encoder under test after a power cycle, counting from its index: each attempt is another power-up.
    PoweredAnew,
}

/// Command of the drive in a step, in addition to or instead of the velocity.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub enum Drive {
    /// The velocity by the drive's own loop.
    #[default]
    Velocity,
    /// The velocity, with a feedforward of motor current.
    Fed(Feedforward),
    /// The velocity up to `from_s`, then motor current alone until its profile ends or `until` is reached.
    Current {
        /// End of the velocity section, from the start of the step.
        from_s: f64,
        /// Motor current (A) over the time of the step.
        current_a: Profile,
        /// Condition that ends the section early.
        until: EndCondition,
    },
}

/// Source of a feedforward current.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Feedforward {
    /// Over the time of the step (A).
    Planned(Profile),
    /// A planned current, and what a share of the measured friction (motor torque less link torque, low-pass filtered)
    /// exceeds it. The latter has the sign of the velocity set-point and is linear in it below `ramp_rad_s` (motor).
    Observed {
        /// Over the time of the step (A).
        #[serde(default = "nothing")]
        planned_a: Profile,
        /// Share of the measured friction that is fed forward.
        share: f64,
        /// Corner frequency of the low-pass.
        corner_hz: f64,
        /// Motor-side speed below which the current is linear in the velocity set-point.
        ramp_rad_s: f64,
    },
    /// A planned current, and a part in proportion to the measured link torque, with the sign of the velocity set-point.
    LoadDependent {
        /// Over the time of the step (A).
        planned_a: Profile,
        /// Current per link torque (A/Nm).
        a_per_nm: f64,
        /// Motor-side speed below which the second part is linear in the velocity set-point.
        ramp_rad_s: f64,
    },
    /// A constant current in the direction of the measured motor velocity.
    MeasuredDirection {
        /// Its magnitude (A).
        current_a: f64,
    },
}

/// Plans of earlier versions have an observer alone.
fn nothing() -> Profile {
    Profile::constant(0.0)
}

impl Feedforward {
    /// The planned part (A), where there is one.
    fn planned_a(&self) -> Option<&Profile> {
        match self {
            Self::Planned(planned_a) | Self::Observed { planned_a, .. } | Self::LoadDependent { planned_a, .. } => {
                Some(planned_a)
            }
            Self::MeasuredDirection { .. } => None,
        }
    }
}

/// Command of the brake current in a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum BrakeControl {
    /// The current of the profile. The guard refuses a fall at standstill, which would leave poles in the rotor.
    #[default]
    Current,
    /// The current of the profile, which falls at standstill because the poles are to be measured. A later step
    /// demagnetises the brake.
    Magnetise,
}

/// End of a section with current alone: the velocity loop takes over after a breakaway.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EndCondition {
    /// Consecutive samples in which the motor moved in the direction of the current.
    pub increases: u32,
    /// Motor-side speed that ends the section in any case.
    pub speed_rad_s: f64,
}

/// One step: a checkpoint at its end, and a repetition from its beginning after a pause.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// Name for people, unique where steps differ.
    pub label: String,
    /// The part of the plan to which it belongs.
    pub phase: Phase,
    /// Number of the step in the run table, unique in a plan.
    pub segment: u32,
    /// Number of the repetition of the whole profile.
    pub repeat: u32,
    /// State of brake and encoder that it requires.
    pub before: InitialState,
    /// Motor-side velocity [rad/s] over the time of the step. Starts and ends at rest.
    pub velocity: Profile,
    /// Brake current (A) over the time of the step.
    pub brake: Profile,
    /// How this current is commanded; plans of earlier versions have no such field.
    #[serde(default)]
    pub brake_control: BrakeControl,
    /// Pose of the stage during the step.
    pub place: StagePose,
    /// Command of the drive.
    pub drive: Drive,
}

impl Step {
    /// Duration without pauses: of the longest of its profiles.
    pub fn duration_s(&self) -> f64 {
        let drive_s = match &self.drive {
            Drive::Velocity => 0.0,
            Drive::Fed(feedforward) => feedforward.planned_a().map_or(0.0, Profile::duration_s),
            Drive::Current { from_s, current_a, .. } => from_s + current_a.duration_s(),
        };
        self.velocity.duration_s().max(self.brake.duration_s()).max(drive_s)
    }

    /// Whether its duration is an upper bound: it ends with the breakaway of the joint, or when the edge is found.
    pub(crate) fn may_end_early(&self) -> bool {
        matches!(self.drive, Drive::Current { .. }) || matches!(self.place, StagePose::Edge(_))
    }

    /// The largest commanded motor current (A).
    pub fn top_motor_current_a(&self) -> f64 {
        match &self.drive {
            Drive::Velocity => 0.0,
            Drive::Fed(Feedforward::MeasuredDirection { current_a }) => *current_a,
            Drive::Fed(feedforward) => feedforward.planned_a().map_or(0.0, Profile::largest),
            Drive::Current { current_a, .. } => current_a.largest(),
        }
    }
}

/// A validated procedure, ready to run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Id of the procedure.
    pub procedure: String,
    /// The parameters, including defaults.
    pub parameters: Map<String, Value>,
    /// Kind of its run table.
    pub kind: Kind,
    /// Facts for the run table, including the baseline model.
    pub meta: Meta,
    /// Control rate: one row of the run table for each tick.
    pub rate_hz: f64,
    /// Motor-side acceleration of the ramps that the engine adds (pause, resume, securing) [rad/s²].
    pub acceleration_rad_s2: f64,
    /// The steps in their order.
    pub steps: Vec<Step>,
    /// Ends the warm-up early. `None`: every step is run.
    pub steady: Option<SteadyCriterion>,
    /// Also records the torque sensor's other range.
    pub both_ranges: bool,
    /// Streaming period of the torque sensor. `None`, or a sensor without streaming: one reading for each row.
    pub torque_period_s: Option<f64>,
    /// `None`: every step is known before the first one.
    #[serde(rename = "lesson")]
    pub deferred: Option<DeferredPlan>,
    /// Start position relative to that of the whole plan (motor) (rad): a continuation begins where the previous run
    /// ended.
    pub begins_rad: f64,
}

impl Plan {
    /// Longest duration: without pauses, and with the whole warm-up.
    pub fn duration_s(&self) -> f64 {
        self.steps.iter().map(Step::duration_s).sum()
    }

    /// Highest motor-side speed [rad/s].
    pub fn top_speed_rad_s(&self) -> f64 {
        self.steps.iter().map(|step| step.velocity.largest()).fold(0.0, f64::max)
    }

    /// Highest absolute motor current that a step commands (A); 0 if none does.
    pub fn top_motor_current_a(&self) -> f64 {
        self.steps.iter().map(Step::top_motor_current_a).fold(0.0, f64::max)
    }

    /// Whether any step commands motor current.
    pub(crate) fn commands_current(&self) -> bool {
        self.steps.iter().any(|step| step.drive != Drive::Velocity)
    }

    /// Highest brake current that a step commands (A).
    pub(crate) fn top_brake_current_a(&self) -> f64 {
        self.steps.iter().map(|step| step.brake.largest()).fold(0.0, f64::max)
    }

    /// Travel of the motor relative to its start: lowest and highest position (rad).
    pub fn travel_rad(&self) -> (f64, f64) {
        let (mut at, mut lowest, mut highest) = (0.0, 0.0_f64, 0.0_f64);
        for step in &self.steps {
            let integral = step.velocity.integral();
            for moved in &integral {
                lowest = lowest.min(at + moved);
                highest = highest.max(at + moved);
            }
            at += integral.last().unwrap_or(&0.0);
        }
        (lowest, highest)
    }
}

/// Why a procedure cannot be planned for a bench.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanFault {
    /// A parameter is unknown or out of its range.
    #[error(transparent)]
    Parameter(#[from] crate::parameter::ParameterFault),
    /// The bench lacks an instrument that the procedure needs.
    #[error("bench {bench} has no {role}: {cure}")]
    MissingInstrument {
        /// Name of the bench.
        bench: String,
        /// Role of the instrument, such as `torque sensor`.
        role: &'static str,
        /// What to do.
        cure: &'static str,
    },
    /// Parameters or facts of the bench exclude each other.
    #[error("{what}: {cure}")]
    Contradiction {
        /// The contradiction, with values.
        what: String,
        /// What to do.
        cure: &'static str,
    },
}

#[cfg(test)]
pub(crate) mod testing {
    use super::*;

    /// A plan of legs at 20 rad/s, alternating, each of the given length.
    pub fn plan_of(durations_s: &[f64]) -> Plan {
        let step = |(index, duration_s): (usize, &f64)| Step {
            label: format!("step {index}"),
            phase: Phase::Measure,
            segment: index as u32,
            repeat: 0,
            before: InitialState::AsLeft,
            velocity: Profile::plateau(if index % 2 == 0 { 20.0 } else { -20.0 }, 200.0, duration_s - 0.2),
            brake: Profile::constant(0.0),
            brake_control: BrakeControl::Current,
            place: StagePose::AsLeft,
            drive: Drive::Velocity,
        };
        Plan {
            procedure: "test".into(),
            parameters: Map::new(),
            kind: Kind::Friction,
            meta: Meta::default(),
            rate_hz: 250.0,
            acceleration_rad_s2: 200.0,
            steps: durations_s.iter().enumerate().map(step).collect(),
            steady: None,
            both_ranges: false,
            torque_period_s: None,
            deferred: None,
            begins_rad: 0.0,
        }
    }

    #[test]
    fn travel_and_duration_add_up() {
        let plan = plan_of(&[1.0, 1.0, 2.0]);
        assert!((plan.duration_s() - 4.0).abs() < 1e-12);
        let (lowest, highest) = plan.travel_rad();
        assert!(lowest.abs() < 1e-9 && (highest - 38.0).abs() < 1e-9, "{lowest} to {highest}");
    }
}
