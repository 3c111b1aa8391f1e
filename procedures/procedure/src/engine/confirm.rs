//! Who is there still: before a step counts as finished, each instrument that it used says again who it is.
//!
//! Another instrument can answer behind a port that was never lost: behind the same adapter, or at the same address. One
//! instrument is asked in one tick, in the last ticks of a step and in none that reads a slow quantity: an identity costs no
//! more than such a reading, and so delays no tick further. A recovered link has identified its instrument already.

use super::ending::Ending;
use super::session::Session;
use crate::state::RunState;
use jointbench_instrument::Kind;

/// Ticks of a step's end that may be taken by slow readings.
const SPARE_TICKS: f64 = 3.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Who {
    Joint,
    TorqueSensor,
    Brake,
    Thermometer,
    Encoder { under_test: bool },
    Stage,
}

/// Whom this step has still to hear from.
#[derive(Debug, Clone, Default)]
pub(super) struct Confirming {
    began: bool,
    left: Vec<Who>,
}

impl Session<'_> {
    /// A step begins: nobody has said anything yet.
    pub(super) fn trust_nobody(&mut self) {
        self.confirming = Confirming::default();
    }

    /// Begins to ask where the step ends in `left_s`.
    pub(super) fn confirm_towards_end(&mut self, left_s: f64) {
        if self.confirming.began {
            return;
        }
        let used = self.used();
        if left_s <= (used.len() as f64 + SPARE_TICKS) * self.beat.period_s {
            self.confirming = Confirming { began: true, left: used };
        }
    }

    /// Asks whom the ticks of the step had no room for, while the shaft goes on as it does.
    pub(super) fn confirm_rest(&mut self) -> Result<(), Ending> {
        self.confirm_towards_end(0.0);
        while !self.confirming.left.is_empty() {
            let now_s = self.wait();
            self.tick(now_s, self.commanded.velocity_rad_s, self.commanded.brake_a)?;
        }
        Ok(())
    }

    /// The next one, in a tick that has room for it.
    pub(super) fn confirm_next(&mut self) -> Result<(), Ending> {
        if self.journal.state() != RunState::Running {
            return Ok(());
        }
        let Some(who) = self.confirming.left.pop() else { return Ok(()) };
        let recovered_before = self.recoveries;
        match who {
            Who::Joint => {
                self.ask_joint(|joint| joint.identify())?;
                self.trust_joint(recovered_before)
            }
            Who::TorqueSensor => self.ask_torque_sensor(|sensor| sensor.identify()).map(drop),
            Who::Brake => self.ask_brake(|brake| brake.identify()).map(drop),
            Who::Thermometer => self.ask_thermometer(|thermometer| thermometer.identify()).map(drop),
            Who::Encoder { under_test } => self.ask_encoder(under_test, |encoder| encoder.identify()).map(drop),
            Who::Stage => self.ask_stage(|stage| stage.identify()).map(drop),
        }
    }

    fn used(&self) -> Vec<Who> {
        let (bench, encoders) = (&self.bench, self.plan.kind == Kind::Encoder);
        // A stream that goes on comes from the sensor that was told to send it; any question would end it.
        let polled = bench.torque_sensor.is_some() && self.streaming.is_none();
        [
            (true, Who::Joint),
            (polled, Who::TorqueSensor),
            (bench.brake.is_some(), Who::Brake),
            (bench.thermometer.is_some(), Who::Thermometer),
            (encoders, Who::Encoder { under_test: false }),
            (encoders, Who::Encoder { under_test: true }),
            (self.pose.is_some(), Who::Stage),
        ]
        .into_iter()
        .filter_map(|(used, who)| used.then_some(who))
        .collect()
    }
}
