//! A power cycle of an encoder: by a switch of the bench, or by a person while the run waits.

use super::ending::Ending;
use super::session::{PendingRequest, Session, reported};
use crate::event::EventKind;
use crate::profile::Profile;
use crate::state::Transition;
use jointbench_instrument::{Fault, FaultKind};
use std::f64::consts::TAU;

/// Longest boot time of a counter after power-up.
const BOOT_S: f64 = 20.0;
const POLL_S: f64 = 0.2;
/// Motor speed and largest distance of the search for an index.
const SEEK_RAD_S: f64 = TAU;
const SEEK_TURNS: f64 = 2.5;

impl Session<'_> {
    /// Ends with the encoder under test switched on, and counting from its index.
    pub(super) fn power_cycle(&mut self) -> Result<(), Ending> {
        self.drive(&self.ramp_to(0.0), &Profile::constant(self.commanded.brake_a))?;
        // An instrument without power is not read.
        self.failed.sensor = true;
        loop {
            let name = self.bench.test_encoder.as_ref().map_or("", |encoder| encoder.name()).to_owned();
            let by_hand = match &mut self.bench.power {
                Some(switch) => switch.cycle(&name).map(|()| false).map_err(Ending::OtherFault)?,
                None => self.wait_for_manual_power_cycle(&name).map(|()| true)?,
            };
            if self.identify_after_power_up()? {
                break;
            }
            let what = "it was not switched off";
            match &self.bench.test_encoder {
                Some(encoder) if !by_hand => return Err(Ending::OtherFault(reported(encoder.as_ref(), what))),
                _ => self.note(format!("{name}: {what}")),
            }
        }
        self.failed.sensor = false;
        self.seek_index()
    }

    /// Waits at standstill until a person confirms.
    fn wait_for_manual_power_cycle(&mut self, name: &str) -> Result<(), Ending> {
        self.note(format!("Switch {name} and its counter off and on, then resume the run."));
        self.enter(Transition::Pause)?;
        while self.pending_request.take() != Some(PendingRequest::Resume) {
            let now_s = self.wait();
            self.tick(now_s, 0.0, self.commanded.brake_a)?;
        }
        self.enter(Transition::Resume)
    }

    /// Polls the identity of the encoder under test until it answers. Returns whether it reported a lost state.
    fn identify_after_power_up(&mut self) -> Result<bool, Ending> {
        let give_up_s = self.bench.clock.now_s() + BOOT_S;
        let mut lost = false;
        loop {
            let Some(encoder) = &mut self.bench.test_encoder else { return Ok(lost) };
            match encoder.identify() {
                Ok(identity) => {
                    let (instrument, port) = (encoder.name().to_owned(), encoder.port().to_owned());
                    let now_s = self.bench.clock.now_s();
                    self.journal.log(now_s, EventKind::Identified { instrument, port, identity });
                    return Ok(lost);
                }
                Err(Fault { kind: FaultKind::Reported { .. }, .. }) if !lost => lost = true,
                Err(fault) if self.bench.clock.now_s() > give_up_s => return Err(Ending::OtherFault(fault)),
                Err(_) => {}
            }
            let here = Profile::from(0.0).hold(POLL_S);
            self.drive(&here, &Profile::constant(self.commanded.brake_a))?;
        }
    }

    /// Turns until the index of the encoder under test has passed.
    fn seek_index(&mut self) -> Result<(), Ending> {
        let brake_a = self.commanded.brake_a;
        self.drive(&self.ramp_to(SEEK_RAD_S), &Profile::constant(brake_a))?;
        let give_up_s = self.bench.clock.now_s() + SEEK_TURNS * TAU / SEEK_RAD_S;
        while !self.ask_encoder(true, |encoder| encoder.seek_index())? {
            let now_s = self.wait();
            if let Some(encoder) = self.bench.test_encoder.as_ref().filter(|_| now_s > give_up_s) {
                let what = format!("no index pulse within {SEEK_TURNS} turns: check its wiring to the counter");
                return Err(Ending::OtherFault(reported(encoder.as_ref(), what)));
            }
            self.tick(now_s, SEEK_RAD_S, brake_a)?;
        }
        self.drive(&self.ramp_to(0.0), &Profile::constant(brake_a))
    }
}
