//! Shared functions of the joint procedures: numbered steps, legs of constant speed, the facts of a friction run.

use super::Procedure;
use crate::bench_facts::BenchFacts;
use crate::brake_timing::{LAG_S, RAISE_S, UNLOAD_S};
use crate::parameter::{Parameter, Values};
use crate::plan::{BrakeControl, Drive, InitialState, Phase, Plan, Step};
use crate::profile::Profile;
use crate::stage_pose::StagePose;
use jointbench_instrument::{Kind, Meta};
use std::f64::consts::TAU;

/// Longest leg that covers a part of a link turn; a very slow gear has to cover less.
const LONGEST_LEG_S: f64 = 15.0;

/// A shorter leg contains no steady state.
const SHORTEST_LEG_S: f64 = 0.5;
/// Largest share of the link's range in one step (chosen).
pub(super) const RANGE_SHARE: f64 = 0.9;

/// The torque sensor sends 1000 samples a second if that gives at least two samples in every row.
const TORQUE_PERIOD_S: f64 = 1e-3;

/// A parameter of nearly every procedure.
pub(super) const ACCELERATION: Parameter =
    Parameter::number("acceleration_rad_s2", "Acceleration (motor)", "rad/s²", 400.0, [10.0, 5000.0]);

pub(super) const fn sample_rate(default_hz: f64) -> Parameter {
    Parameter::number("sample_rate_hz", "Control and sample rate", "Hz", default_hz, [50.0, 1000.0])
}

/// Collects steps and numbers their segments.
pub(super) struct Legs {
    pub acceleration_rad_s2: f64,
    pub steps: Vec<Step>,
    pub phase: Phase,
    pub repeat: u32,
}

impl Legs {
    pub fn new(acceleration_rad_s2: f64) -> Self {
        Self { acceleration_rad_s2, steps: Vec::new(), phase: Phase::Measure, repeat: 0 }
    }

    /// A constant speed at a constant brake current.
    pub fn leg(&mut self, speed_rad_s: f64, dwell_s: f64, brake_a: f64) {
        let label = if brake_a > 0.0 {
            format!("{speed_rad_s:+.1} rad/s at {brake_a:.2} A")
        } else {
            format!("{speed_rad_s:+.1} rad/s")
        };
        self.push(label, Profile::plateau(speed_rad_s, self.acceleration_rad_s2, dwell_s), Profile::constant(brake_a));
    }

    /// Changes the brake current during rotation, out and back.
    pub fn change(&mut self, speed_rad_s: f64, from_a: f64, to_a: f64) {
        let velocity = |sign: f64| Profile::plateau(sign * speed_rad_s, self.acceleration_rad_s2, RAISE_S + LAG_S);
        let (out, back) = (velocity(1.0), velocity(-1.0));
        let turning_s = speed_rad_s / self.acceleration_rad_s2;
        let brake = Profile::from(from_a).hold(turning_s).to(to_a, RAISE_S);
        self.push(format!("brake to {to_a:.2} A, forward"), out, brake);
        self.push(format!("brake at {to_a:.2} A, return"), back, Profile::constant(to_a));
    }

    /// One step at constant speed in which the current passes a history from 0 back to 0. It is one step, so that it
    /// is repeated as a whole after a pause.
    pub fn sweep(&mut self, label: String, speed_rad_s: f64, currents_a: &[f64], dwell_s: f64) {
        let turning_s = speed_rad_s.abs() / self.acceleration_rad_s2;
        let mut brake = Profile::from(0.0).hold(turning_s);
        for current_a in currents_a.iter().chain([&0.0]) {
            brake = brake.to(*current_a, 0.0).hold(dwell_s);
        }
        let velocity = Profile::plateau(speed_rad_s, self.acceleration_rad_s2, brake.duration_s() - turning_s + LAG_S);
        self.push(label, velocity, brake);
        let last = self.steps.len() - 1;
        self.steps[last].before = InitialState::Demagnetised;
    }

    /// The rated current, then zero over `turns` of the link, so that no pole keeps its history.
    pub fn demagnetise(&mut self, speed_rad_s: f64, rated_a: f64, turns: f64, bench: &BenchFacts) {
        let turning_s = speed_rad_s / self.acceleration_rad_s2;
        let ramp_s = (turns * TAU * bench.constants.gear_ratio / speed_rad_s).max(UNLOAD_S);
        let brake = Profile::from(0.0).hold(turning_s).to(rated_a, RAISE_S).hold(LAG_S).to(0.0, ramp_s).hold(LAG_S);
        let velocity = Profile::plateau(speed_rad_s, self.acceleration_rad_s2, brake.duration_s() - turning_s);
        let back = Profile::plateau(-speed_rad_s, self.acceleration_rad_s2, brake.duration_s() - turning_s);
        self.push("demagnetise the brake while turning".into(), velocity, brake);
        self.push("back".into(), back, Profile::constant(0.0));
    }

    /// The brake current falls to zero over at least one link turn, as fast as the joint turns. The joint returns
    /// without load.
    pub fn unload(&mut self, speed_rad_s: f64, from_a: f64, bench: &BenchFacts) {
        let ramp_s = turn_s(1.0, speed_rad_s, bench, UNLOAD_S);
        let turning_s = speed_rad_s / self.acceleration_rad_s2;
        let velocity = Profile::plateau(speed_rad_s, self.acceleration_rad_s2, ramp_s + LAG_S);
        let brake = Profile::from(from_a).hold(turning_s).to(0.0, ramp_s);
        self.push("demagnetise the brake while turning".into(), velocity, brake);
        self.leg(-speed_rad_s, ramp_s + LAG_S, 0.0);
    }

    /// Back to the start of a motion, without brake current.
    pub fn way_back(&mut self, way_rad: f64, top_rad_s: f64) {
        if way_rad != 0.0 {
            let velocity = stroke(-way_rad, top_rad_s, self.acceleration_rad_s2);
            self.push("back".into(), velocity, Profile::constant(0.0));
        }
    }

    /// The plan of a friction procedure without its own warm-up.
    pub fn friction_plan(self, procedure: &dyn Procedure, values: &Values, bench: &BenchFacts, rate_hz: f64) -> Plan {
        self.plan(procedure, values, friction_meta(bench, rate_hz), rate_hz)
    }

    /// The plan of these legs, with the facts about its run.
    pub fn plan(self, procedure: &dyn Procedure, values: &Values, meta: Meta, rate_hz: f64) -> Plan {
        let measures_torque = matches!(procedure.kind(), Kind::Stiffness | Kind::Brake);
        Plan {
            procedure: procedure.id().to_owned(),
            parameters: values.to_json(),
            kind: procedure.kind(),
            meta,
            rate_hz,
            acceleration_rad_s2: self.acceleration_rad_s2,
            steps: self.steps,
            steady: None,
            both_ranges: false,
            torque_period_s: (measures_torque && rate_hz * TORQUE_PERIOD_S <= 0.5).then_some(TORQUE_PERIOD_S),
            deferred: None,
            begins_rad: 0.0,
        }
    }

    pub fn drive_of_last(&mut self, drive: Drive) {
        if let Some(step) = self.steps.last_mut() {
            step.drive = drive;
        }
    }

    /// Rotation of the motor by the last step (rad).
    pub fn way_of_last(&self) -> f64 {
        self.steps.last().and_then(|step| step.velocity.integral().last().copied()).unwrap_or(0.0)
    }

    pub fn push(&mut self, label: String, velocity: Profile, brake: Profile) {
        let segment = self.steps.len() as u32;
        let (phase, repeat, before) = (self.phase, self.repeat, InitialState::AsLeft);
        self.steps.push(Step {
            label,
            phase,
            segment,
            repeat,
            before,
            velocity,
            brake,
            brake_control: BrakeControl::Current,
            drive: Drive::Velocity,
            place: StagePose::AsLeft,
        });
    }
}

/// A stroke of a given length, as fast as its acceleration permits.
pub(super) fn stroke(way_rad: f64, top_rad_s: f64, acceleration_rad_s2: f64) -> Profile {
    let speed_rad_s = top_rad_s.min((0.5 * way_rad.abs() * acceleration_rad_s2).sqrt());
    let dwell_s = way_rad.abs() / speed_rad_s - speed_rad_s / acceleration_rad_s2;
    Profile::plateau(speed_rad_s.copysign(way_rad), acceleration_rad_s2, dwell_s.max(0.0))
}

/// Duration of a leg that covers a share of a link turn, at least `least_s`.
pub(super) fn turn_s(share: f64, speed_rad_s: f64, bench: &BenchFacts, least_s: f64) -> f64 {
    (share * TAU * bench.constants.gear_ratio / speed_rad_s.abs()).min(LONGEST_LEG_S).max(least_s)
}

/// A dwell time, limited by the link's range.
pub(super) fn within_range_s(dwell_s: f64, speed_rad_s: f64, acceleration_rad_s2: f64, bench: &BenchFacts) -> f64 {
    let range_rad = bench.constants.link_range_rad.unwrap_or(f64::INFINITY);
    let room_rad = RANGE_SHARE * range_rad * bench.constants.gear_ratio;
    dwell_s.min(room_rad / speed_rad_s - speed_rad_s / acceleration_rad_s2).max(SHORTEST_LEG_S)
}

/// The facts of a friction table, and the baseline model.
pub(super) fn friction_meta(bench: &BenchFacts, rate_hz: f64) -> Meta {
    let constants = &bench.constants;
    let mut baseline = vec!["inertia", "load_transmission", "coulomb", "viscous"];
    if !bench.has_torque_sensor {
        baseline.retain(|effect| *effect != "load_transmission");
    }
    Meta {
        kind: Some(Kind::Friction),
        baseline: baseline.into_iter().map(str::to_owned).collect(),
        sample_rate_hz: Some(rate_hz),
        torque_constant_nm_per_a: Some(constants.torque_constant_nm_per_a),
        gear_ratio: Some(constants.gear_ratio),
        rotor_inertia_kg_m2: Some(constants.rotor_inertia_kg_m2),
        rated_current_a: bench.has_brake.then_some(constants.brake_rated_current_a),
        ..Meta::default()
    }
}

#[cfg(test)]
pub(super) mod testing {
    use crate::bench_facts::BenchFacts;
    use jointbench_instrument::Limits;
    use jointbench_instrument::bench::JointConstants;
    use std::f64::consts::TAU;

    /// Joint A of docs/documents.md with brake A.
    pub fn joint_a() -> BenchFacts {
        BenchFacts {
            name: "a".into(),
            simulated: true,
            limits: Limits {
                motor_velocity_rad_s: 250.0,
                motor_current_a: 10.0,
                link_torque_nm: 18.0,
                temperature_c: 80.0,
                brake_current_a: 0.6,
                brake_power_w: 350.0,
            },
            constants: JointConstants {
                torque_constant_nm_per_a: 0.0406,
                gear_ratio: 177.8,
                rotor_inertia_kg_m2: 1.0e-5,
                brake_compliance_v: 45.0,
                brake_rated_current_a: 0.6,
                brake_rated_torque_nm: 13.0,
                link_range_rad: Some(5.0 * TAU),
                load_gear_ratio: None,
            },
            has_torque_sensor: true,
            has_two_ranges: true,
            has_brake: true,
            encoder_counts: None,
            has_stage: false,
            amperes_per_volt: None,
            setpoint_interval: None,
            brake_model: None,
            compared_brake: None,
            feeds_forward: true,
        }
    }

    pub fn joint_b() -> BenchFacts {
        let mut facts = joint_a();
        facts.name = "b".into();
        facts.constants.torque_constant_nm_per_a = 0.0798;
        facts.constants.gear_ratio = 50.0;
        facts.constants.rotor_inertia_kg_m2 = 4.0e-5;
        facts.constants.link_range_rad = None;
        facts
    }
}
