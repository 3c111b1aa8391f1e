//! One control period: poll the controls, command, read, check, record.

use super::arm::link_position_rad;
use super::ending::Ending;
use super::session::{
    BrakeCommand, BrakeCurrent, DriveCommand, PendingRequest, RECOVERIES_PER_STEP, Session, reported,
};
use crate::columns::{TickBrake, TickValues, VELOCITY_STEP_RAD_S, to_time_step};
use crate::event::{Control, Demand, EventKind};
use crate::guard::Sample;
use crate::state::{RunState, Transition};
use jointbench_instrument::FaultKind;
use jointbench_instrument::clock::timed;
use jointbench_instrument::roles::Regulation;
use jointbench_instrument::units::{Amperes, RadPerSec};
use std::sync::Arc;
use std::sync::mpsc::TryRecvError;

/// A supply needs up to 118 ms for a new current (scpi-current-source, timing), so that faster commands would only
/// queue.
const BRAKE_EVERY_S: f64 = 0.1;
/// Period of temperature and supply readings, which are held in between.
pub const SLOW_EVERY_S: f64 = 0.5;
/// Reading period while the brake current changes: a supply can deliver 10 to 20 readings in a second
/// (scpi-current-source, timing).
const CHANGING_EVERY_S: f64 = 0.1;
/// Time until a new current is steady after its command: supply and coil.
const CHANGES_FOR_S: f64 = 1.0;
/// Reading period of the thermometer: a resistance thermometer in a housing has a time constant of 10 to 30 s, and
/// its reply takes several ticks.
const THERMOMETER_EVERY_S: f64 = 2.0;
/// Longest time without regulation of the supply. CV for more than 0.5 s at a commanded CC is a fault. A rising
/// current needs the full voltage for a moment.
const UNREGULATED_S: f64 = 1.0;

impl Session<'_> {
    /// Waits for the next tick and returns its time.
    pub(super) fn wait(&mut self) -> f64 {
        self.bench.clock.sleep_until_s(self.period.next_s);
        let now_s = self.bench.clock.now_s();
        if now_s > self.period.next_s + self.period.duration_s {
            self.period.late_ticks += 1;
        }
        self.period.next_s = (self.period.next_s + self.period.duration_s).max(now_s);
        now_s
    }

    /// A tick at a velocity, whose row is shown but not kept.
    pub(super) fn tick(&mut self, now_s: f64, velocity_rad_s: f64, brake_a: f64) -> Result<(), Ending> {
        self.tick_with(
            now_s,
            DriveCommand::Velocity { rad_s: velocity_rad_s, feedforward_a: 0.0 },
            brake_a.into(),
            None,
        )
    }

    /// `keep` has segment and repeat of the row; without it the row is shown but not kept.
    pub(super) fn tick_with(
        &mut self,
        now_s: f64,
        command: DriveCommand,
        brake: BrakeCommand,
        keep: Option<(u32, u32)>,
    ) -> Result<(), Ending> {
        self.poll_controls(now_s)?;
        self.command_brake(now_s, brake)?;
        match command {
            DriveCommand::Velocity { rad_s, feedforward_a } => self.command_velocity(rad_s, feedforward_a)?,
            DriveCommand::Current { a } => self.command_motor_current(a)?,
        }
        let values = self.read(now_s)?;
        self.check(now_s, &values)?;
        self.record(now_s, &values, keep);
        if self.journal.state() != RunState::Securing {
            self.journal.commit_if_due(now_s)?;
        }
        Ok(())
    }

    pub(super) fn poll_controls(&mut self, now_s: f64) -> Result<(), Ending> {
        loop {
            let Demand { control, by } = match self.controls.try_recv() {
                Ok(demand) => demand,
                Err(TryRecvError::Empty) => return Ok(()),
                Err(TryRecvError::Disconnected) if self.journal.state() == RunState::Securing => return Ok(()),
                Err(TryRecvError::Disconnected) => return Err(Ending::Abandoned),
            };
            self.journal.log(now_s, EventKind::Control { control, by });
            match control {
                Control::EStop => return Err(Ending::EStopped),
                Control::Abort => return Err(Ending::Aborted),
                Control::Quit => return Err(Ending::Quit),
                Control::StorageLost => return Err(Ending::StorageLost),
                Control::Stop | Control::Abandon if self.journal.state() == RunState::Securing => {}
                Control::Stop => return Err(Ending::Stopped),
                Control::Abandon => return Err(Ending::Abandoned),
                Control::Pause => self.request(PendingRequest::Pause, Transition::Pause),
                Control::Resume => self.request(PendingRequest::Resume, Transition::Resume),
            }
        }
    }

    /// A request cancels an opposite one that is still pending. A request that the state does not permit is reported
    /// and dropped.
    fn request(&mut self, request: PendingRequest, transition: Transition) {
        if self.pending_request.take_if(|pending| *pending != request).is_some() {
            return;
        }
        match self.journal.state().after(transition) {
            Ok(_) => self.pending_request = Some(request),
            Err(illegal) => self.note(illegal.to_string()),
        }
    }

    fn command_velocity(&mut self, velocity_rad_s: f64, feedforward_a: f64) -> Result<(), Ending> {
        let velocity_rad_s = (velocity_rad_s / VELOCITY_STEP_RAD_S).round() * VELOCITY_STEP_RAD_S;
        self.guard.check_velocity(velocity_rad_s).map_err(Ending::CommandRefused)?;
        self.guard.check_motor_current(feedforward_a).map_err(Ending::CommandRefused)?;
        let recovered_before = self.recoveries;
        // Sent in every tick, because it feeds the drive's watchdog.
        self.ask_joint(|joint| joint.set_velocity_fed(RadPerSec(velocity_rad_s), Amperes(feedforward_a)))?;
        self.commanded.velocity_rad_s = velocity_rad_s;
        self.commanded.motor_current_a = feedforward_a;
        self.trust_joint(recovered_before)
    }

    fn command_motor_current(&mut self, current_a: f64) -> Result<(), Ending> {
        self.guard.check_motor_current(current_a).map_err(Ending::CommandRefused)?;
        let recovered_before = self.recoveries;
        self.ask_joint(|joint| joint.set_motor_current(Amperes(current_a)))?;
        self.commanded.velocity_rad_s = self.joint.map_or(0.0, |reading| reading.motor_velocity.0);
        self.commanded.motor_current_a = current_a;
        self.trust_joint(recovered_before)
    }

    fn command_brake(&mut self, now_s: f64, command: BrakeCommand) -> Result<(), Ending> {
        let Some(brake) = self.bench.brake.as_ref().filter(|_| !self.failed.brake) else { return Ok(()) };
        let brake_a = match brake.resolution() {
            Some(step) => (command.a / step.0).round() * step.0,
            None => command.a,
        };
        let before = self.commanded;
        if brake_a == before.brake_a || now_s < before.brake_at_s + BRAKE_EVERY_S {
            return Ok(());
        }
        let checked = match command.magnetises {
            true => self.guard.check_magnetising_brake(brake_a),
            false => self.guard.check_brake(brake_a),
        };
        checked.map_err(Ending::CommandRefused)?;
        self.commanded.brake_a = brake_a;
        self.commanded.brake_at_s = now_s;
        self.ask_brake(|brake| brake.set_current(Amperes(brake_a)))?;
        Ok(())
    }

    fn read(&mut self, now_s: f64) -> Result<TickValues, Ending> {
        let recovered_before = self.recoveries;
        let joint = self.ask_joint(|joint| joint.read())?;
        self.trust_joint(recovered_before)?;
        self.joint = Some(joint);
        let torque = self.read_torque(&joint)?;
        self.link_torque_nm = torque.map(|torque| torque.nm);
        let encoders = self.read_encoders()?;
        if now_s >= self.held.next_s {
            self.held.next_s = now_s + SLOW_EVERY_S;
            self.check_drive()?;
        }
        if now_s >= self.held.brake_next_s && !self.failed.brake {
            let changes = now_s < self.commanded.brake_at_s + CHANGES_FOR_S;
            self.held.brake_next_s = now_s + if changes { CHANGING_EVERY_S } else { SLOW_EVERY_S };
            self.read_brake()?;
        }
        if now_s >= self.thermometer_next_s {
            self.read_thermometer()?;
        }
        let row_s = encoders.map_or(joint.at_s, |both| both.test.at_s);
        Ok(TickValues {
            time_s: to_time_step(row_s - self.journal.started_s),
            joint,
            torque,
            temperature_c: self.held.temperature_c,
            thermometer_skew_s: self.thermometer_at_s - row_s,
            brake: self.held.brake.map(|current| TickBrake {
                measured_a: current.a,
                skew_s: current.at_s - joint.at_s,
                commanded_a: self.commanded.brake_a,
            }),
            velocity_setpoint_rad_s: self.commanded.velocity_rad_s,
            encoders,
            pose: self.pose,
            motor_current_setpoint_a: self.commanded.motor_current_a,
        })
    }

    /// Reads the thermometer if there is one. The first channel replaces the joint's temperature if the joint has
    /// none.
    pub(super) fn read_thermometer(&mut self) -> Result<(), Ending> {
        if self.failed.thermometer {
            return Ok(());
        }
        let clock = Arc::clone(&self.bench.clock);
        if let Some(reading) = self.ask_thermometer(|thermometer| timed(&*clock, || thermometer.read()))? {
            self.thermometer_next_s = clock.now_s() + THERMOMETER_EVERY_S;
            self.thermometer_at_s = reading.at_s;
            self.thermometer_c = reading.value.iter().map(|temperature| temperature.0).collect();
        }
        Ok(())
    }

    fn read_brake(&mut self) -> Result<(), Ending> {
        let clock = Arc::clone(&self.bench.clock);
        if let Some(timed) = self.ask_brake(|brake| timed(&*clock, || brake.read()))? {
            let (reading, at_s) = (timed.value, timed.at_s);
            self.held.brake = Some(BrakeCurrent { a: reading.current.0, at_s });
            let loaded = self.commanded.brake_a > 0.02 * self.bench.constants.brake_rated_current_a;
            let holds = !loaded || reading.regulation == Regulation::ConstantCurrent;
            let since_s = (!holds).then(|| self.held.unregulated_since_s.unwrap_or(at_s));
            self.held.unregulated_since_s = since_s;
            if let Some(brake) = &self.bench.brake
                && since_s.is_some_and(|since_s| at_s >= since_s + UNREGULATED_S)
            {
                let what = format!(
                    "the supply does not reach {:.3} A ({:?} at {:.1} V): check the coil for overheating and \
                     disconnection",
                    self.commanded.brake_a, reading.regulation, reading.voltage.0
                );
                return Err(Ending::OtherFault(reported(brake.as_ref(), what)));
            }
        }
        Ok(())
    }

    /// Checks that the drive still applies torque and reports no error.
    fn check_drive(&mut self) -> Result<(), Ending> {
        let health = self.ask_joint(|joint| joint.health())?;
        if !health.armed || !health.errors.is_empty() {
            let what = format!("the drive disarmed during the run: {}", health.errors.join(", "));
            return Err(Ending::JointFault(reported(self.bench.joint.as_ref(), what)));
        }
        let own_c = health.temperature.map(|temperature| temperature.0);
        self.held.temperature_c = own_c.or(self.thermometer_c.first().copied());
        Ok(())
    }

    /// The drive's watchdog was not fed while a link was recovered.
    fn trust_joint(&mut self, recovered_before: u32) -> Result<(), Ending> {
        if self.recoveries == recovered_before {
            return Ok(());
        }
        if self.recoveries > RECOVERIES_PER_STEP {
            let what = format!("{} replies missing within one step: check cable and shield", self.recoveries);
            return Err(Ending::JointFault(reported(self.bench.joint.as_ref(), what)));
        }
        self.check_drive()
    }

    fn check(&mut self, now_s: f64, values: &TickValues) -> Result<(), Ending> {
        let joint = &values.joint;
        if !joint.motor_position.0.is_finite() || !joint.link_position.is_none_or(|position| position.0.is_finite()) {
            let kind = FaultKind::Garbled { what: "a position that is not a number".into() };
            return Err(Ending::JointFault(kind.at(self.bench.joint.name(), self.bench.joint.port())));
        }
        let gear_ratio = self.bench.constants.gear_ratio;
        let sample = Sample {
            at_s: now_s,
            motor_velocity_rad_s: joint.motor_velocity.0,
            motor_current_a: joint.motor_current.0,
            link_position_rad: link_position_rad(joint, gear_ratio),
            torsion_rad: joint.link_position.map(|link| joint.motor_position.0 / gear_ratio - link.0),
            link_torque_nm: values.torque.map(|torque| torque.peak_nm),
            temperature_c: values.temperature_c,
            brake_current_a: values.brake.map(|brake| brake.measured_a),
        };
        self.guard.check_sample(&sample).map_err(Ending::SampleRefused)
    }

    fn record(&mut self, now_s: f64, values: &TickValues, keep: Option<(u32, u32)>) {
        // A reading that is not newer than the previous row is a duplicate. Without an instrument, or without its
        // reading, there is no row.
        let has_torque = values.torque.is_some() || self.bench.torque_sensor.is_none();
        let is_row = values.time_s > self.row_s && has_torque && !self.failed.sensor;
        let Some(columns) = self.columns.as_mut().filter(|_| is_row) else { return };
        self.row_s = values.time_s;
        let (segment, repeat) = keep.unwrap_or_default();
        let row = columns.row(values, &self.thermometer_c, segment, repeat);
        if keep.is_some() {
            self.journal.keep(row);
            self.deferred.add_row(self.plan.deferred.as_ref(), segment, row);
            if let Some(encoders) = &values.encoders {
                self.shaft.add(segment, &values.joint, encoders);
            }
        }
        let (pace, started_s) = (&self.remaining_time, self.journal.started_s);
        self.journal.show(now_s, row, || pace.progress(started_s, now_s, keep.is_some()));
    }
}
