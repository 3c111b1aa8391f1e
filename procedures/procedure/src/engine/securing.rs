//! The path from any state of a run to the safe state, as gentle as its ending permits.

use super::ending::{Ending, Urgency};
use super::safe_state::secure;
use super::session::Session;
use crate::brake_timing::UNLOAD_S;
use crate::event::{EventKind, Safe};
use crate::guard::STANDSTILL_LINK_RAD_S;
use crate::profile::Profile;
use jointbench_instrument::Fault;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Longest duration of unloading the brake: a plan that only creeps does not get a whole turn.
const LONGEST_UNLOAD_S: f64 = 15.0;
/// Fastest link speed of unloading: 60 rpm.
const UNLOAD_LINK_RAD_S: f64 = TAU;
/// Dead time of the supply and delay of the coil, before the shaft may stop after a falling current.
const BRAKE_LAG_S: f64 = 0.5;
/// Time until a reconnected plug is a port, and polling period.
const PLUGGED_S: f64 = 1.0;
const POLL_S: f64 = 0.2;
/// Shortest ramp of an abort.
const QUICK_S: f64 = 0.3;

impl Session<'_> {
    /// Never fails: if the gentle path fails, the hard one follows, and the result is reported.
    pub(super) fn make_safe(&mut self, ending: &Ending) -> Safe {
        let mut urgency = if self.armed { ending.urgency() } else { Urgency::Cut };
        if urgency == Urgency::Orderly {
            match self.caught(Session::unload) {
                Ok(()) => {}
                Err(hurry) => {
                    self.note(format!("Securing escalated to a faster stop: {hurry}"));
                    urgency = hurry.urgency().max(Urgency::Quick);
                }
            }
        }
        // A supply that no longer answers is switched off at once, while the shaft still turns.
        if self.failed.brake
            && let Some(Err(fault)) = self.bench.brake.as_mut().map(|brake| brake.command_off())
        {
            tracing::warn!("the brake was not switched off before the joint stopped: {fault}");
        }
        if urgency == Urgency::Quick
            && let Err(hurry) = self.caught(Session::stop_shaft)
        {
            self.note(format!("Securing escalated to a faster stop: {hurry}"));
        }
        let secured = secure(self.bench);
        secured.notes.into_iter().for_each(|note| self.note(note));
        secured.safe
    }

    /// A lost instrument may have been exchanged: another instrument that answers at its port becomes the reason.
    pub(super) fn check_for_exchange(&mut self, ending: &mut Ending) {
        let Some(gone) = ending.fault_mut().filter(|fault| fault.is_port_lost()) else { return };
        let clock = Arc::clone(&self.bench.clock);
        let Some(instrument) = self.bench.instrument(&gone.instrument) else { return };
        let give_up_s = clock.now_s() + PLUGGED_S;
        let found = loop {
            match instrument.recover() {
                Err(fault) if fault.is_port_lost() && clock.now_s() < give_up_s => {
                    clock.sleep_until_s(clock.now_s() + POLL_S);
                }
                found => break found,
            }
        };
        if let Err(found) = found
            && found.is_wrong_instrument()
        {
            *gone = found.clone();
            self.journal.log(clock.now_s(), EventKind::Fault { fault: found, recovered: false });
        }
    }

    /// Another instrument can answer at a port that was never lost. Each instrument is identified again when the
    /// bench is safe, because there is no time for it during the steps. A run that ended with a fault already has its
    /// reason.
    pub(super) fn identify_again(&mut self, ending: &mut Ending) {
        if !self.armed || ending.fault_mut().is_some() {
            return;
        }
        let found = self.bench.instruments().into_iter().filter_map(|instrument| instrument.identify().err());
        let exchanged: Vec<_> = found.filter(Fault::is_wrong_instrument).collect();
        let now_s = self.bench.clock.now_s();
        for fault in exchanged {
            let name = fault.instrument.clone();
            self.journal.log(now_s, EventKind::Fault { fault: fault.clone(), recovered: false });
            self.warn(format!("{name} was exchanged during the run: its readings may come from either instrument"));
            if matches!(ending, Ending::Completed) {
                *ending = Ending::OtherFault(fault);
            }
        }
    }

    /// Removes the brake current during rotation, then stops the shaft.
    pub(super) fn unload(&mut self) -> Result<(), Ending> {
        let brake_a = self.commanded.brake_a;
        let speed_rad_s = self.unload_speed_rad_s();
        let link_rad_s = speed_rad_s.abs() / self.bench.constants.gear_ratio;
        if brake_a > 0.0 && link_rad_s > STANDSTILL_LINK_RAD_S {
            let unload_s = (TAU / link_rad_s).clamp(UNLOAD_S, LONGEST_UNLOAD_S);
            let up = self.ramp_to(speed_rad_s);
            let up_s = up.duration_s();
            let velocity = up.hold(unload_s + BRAKE_LAG_S);
            let brake = Profile::from(brake_a).hold(up_s).to(0.0, unload_s);
            self.drive(&velocity, &brake)?;
        }
        self.drive(&self.ramp_to(0.0), &Profile::constant(self.commanded.brake_a))
    }

    /// At most the highest speed of the plan, towards the middle of the range if there is one.
    pub(super) fn unload_speed_rad_s(&self) -> f64 {
        let constants = &self.bench.constants;
        let speed_rad_s = self.plan.top_speed_rad_s().min(UNLOAD_LINK_RAD_S * constants.gear_ratio);
        let position_rad = self.joint.map_or(0.0, |reading| reading.motor_position.0);
        let ahead = match constants.link_range_rad {
            Some(_) if position_rad != 0.0 => -position_rad,
            _ => self.commanded.velocity_rad_s,
        };
        speed_rad_s.copysign(ahead)
    }

    /// Stops the shaft without speeding up first. Securing removes the brake current, because no supply answers in
    /// time to keep the shaft turning until the current has fallen. Securing also reports the remanence of a fall at
    /// standstill, with the current that caused it.
    fn stop_shaft(&mut self) -> Result<(), Ending> {
        let velocity_rad_s = self.commanded.velocity_rad_s;
        let rest_s = QUICK_S.max(velocity_rad_s.abs() / self.plan.acceleration_rad_s2);
        let velocity = Profile::from(velocity_rad_s).to(0.0, rest_s);
        self.drive(&velocity, &Profile::constant(self.commanded.brake_a))
    }
}
