//! Checks before any motion: identity and health of the instruments, and the limits of the plan on this bench.

use super::ending::Ending;
use super::session::{Session, reported};
use crate::bench_facts::BenchFacts;
use crate::columns::Columns;
use crate::event::EventKind;
use jointbench_instrument::TorsionLimit;
use jointbench_instrument::roles::JointReading;
use jointbench_instrument::units::{Amperes, RadPerSec, Volts};

impl Session<'_> {
    pub(super) fn arm(&mut self) -> Result<(), Ending> {
        if let Some(reason) = self.journal.blocked()? {
            let name = &self.bench.name;
            return Err(Ending::NotReady(format!(
                "bench {name} is blocked ({reason}): inspect the bench, then reset it"
            )));
        }
        self.check_plan()?;
        self.identify()?;
        self.identify_encoders()?;
        let health = self.ask_joint(|joint| joint.health())?;
        if !health.errors.is_empty() {
            let what = format!("{}; clear the error before the run", health.errors.join(", "));
            return Err(Ending::JointFault(reported(self.bench.joint.as_ref(), what)));
        }
        let reading = self.ask_joint(|joint| joint.read())?;
        self.check_range(&reading)?;
        self.joint = Some(reading);

        let compliance = Volts(self.bench.constants.brake_compliance_v);
        self.ask_brake(|brake| brake.prepare(compliance))?;
        let (speed, current) = (self.bench.limits.motor_velocity_rad_s, self.bench.limits.motor_current_a);
        // From here on securing has to remove torque, even if the reply to this request is lost.
        self.armed = true;
        self.ask_joint(|joint| joint.arm(RadPerSec(speed), Amperes(current)))?;
        let health = self.ask_joint(|joint| joint.health())?;
        if !health.armed {
            let what = format!("the drive did not arm: {}", health.errors.join(", "));
            return Err(Ending::JointFault(reported(self.bench.joint.as_ref(), what)));
        }

        self.read_thermometer()?;
        self.start_torque_stream()?;
        let (moves_stage, streams, thermometers) =
            (self.pose.is_some(), self.torque_stream.is_some(), self.thermometer_c.len());
        let columns = Columns::of(self.plan, moves_stage, streams, self.bench, &reading, &health, thermometers);
        self.deferred.set_columns(columns.empty_trace());
        self.journal.set_columns(columns.empty_trace());
        self.columns = Some(columns);
        if health.temperature.is_none() && self.thermometer_c.is_empty() {
            self.note("No temperature signal: the temperature limit is not monitored.");
        }
        if self.bench.torque_sensor.is_none() {
            self.note("No torque sensor: limits of link torque and brake power are not monitored.");
        }
        if let Some(TorsionLimit { compliance_rad_per_nm, tolerance_rad }) = self.bench.torsion {
            let (compliance, tolerance) = (1e3 * compliance_rad_per_nm, 1e3 * tolerance_rad);
            self.note(format!("Torsion is monitored: {compliance:.4} mrad/Nm, tolerance {tolerance:.3} mrad."));
        }
        self.period.next_s = self.bench.clock.now_s();
        Ok(())
    }

    fn check_plan(&self) -> Result<(), Ending> {
        let checks = self.plan.preview(&BenchFacts::of(self.bench)).checks;
        match checks.iter().find(|check| !check.ok) {
            None => Ok(()),
            Some(check) => {
                let cure = check.cure.as_ref().map(|cure| format!(": {cure}")).unwrap_or_default();
                Err(Ending::NotReady(format!("{}, {}{cure}", check.name, check.detail)))
            }
        }
    }

    fn identify(&mut self) -> Result<(), Ending> {
        let mut found = Vec::new();
        let identity = self.ask_joint(|joint| joint.identify())?;
        found.push((self.bench.joint.name().to_owned(), self.bench.joint.port().to_owned(), identity));
        if let Some(identity) = self.ask_torque_sensor(|sensor| sensor.identify())? {
            let sensor = self.bench.torque_sensor.as_ref();
            found.extend(sensor.map(|sensor| (sensor.name().to_owned(), sensor.port().to_owned(), identity)));
        }
        if let Some(identity) = self.ask_brake(|brake| brake.identify())? {
            let brake = self.bench.brake.as_ref();
            found.extend(brake.map(|brake| (brake.name().to_owned(), brake.port().to_owned(), identity)));
        }
        if let Some(identity) = self.ask_thermometer(|thermometer| thermometer.identify())? {
            let thermometer = self.bench.thermometer.as_ref();
            found.extend(
                thermometer.map(|thermometer| (thermometer.name().to_owned(), thermometer.port().to_owned(), identity)),
            );
        }
        let now_s = self.bench.clock.now_s();
        for (instrument, port, identity) in found {
            self.journal.log(now_s, EventKind::Identified { instrument, port, identity });
        }
        Ok(())
    }

    /// The plan starts at the present position, so that its whole travel has to fit from there.
    fn check_range(&self, reading: &JointReading) -> Result<(), Ending> {
        let constants = &self.bench.constants;
        let Some(range_rad) = constants.link_range_rad else { return Ok(()) };
        let here_rad = link_position_rad(reading, constants.gear_ratio);
        let (lowest, highest) = self.plan.travel_rad();
        for travel_rad in [lowest, highest] {
            let position_rad = here_rad + travel_rad / constants.gear_ratio;
            // A position of NaN does not fit either.
            let fits = position_rad.abs() <= range_rad;
            if !fits {
                return Err(Ending::NotReady(format!(
                    "the link would move to {position_rad:.2} rad, beyond its range of ±{range_rad:.2} rad: move it \
                     towards the centre of the range"
                )));
            }
        }
        Ok(())
    }
}

/// From the link encoder, or through the gear ratio without one.
pub(super) fn link_position_rad(reading: &JointReading, gear_ratio: f64) -> f64 {
    reading.link_position.map_or(reading.motor_position.0 / gear_ratio, |position| position.0)
}
