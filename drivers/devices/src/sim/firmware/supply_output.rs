//! The output of a supply that is wired to a brake's coil.

use super::dp800_channel::Channel;
use crate::sim::plant::{CoilSupply, Plant, Signal};
use std::collections::VecDeque;

/// Time from a command to the change at the output (DP800 data sheet; assumed for others).
const LATENCY_S: f64 = 0.118;
const READBACK_NOISE_A: f64 = 2e-4;
const READBACK_NOISE_V: f64 = 1e-3;

/// Changes that have not reached the coil yet.
#[derive(Debug, Default)]
pub struct CoilOutput {
    underway: VecDeque<(f64, Option<CoilSupply>)>,
}

impl CoilOutput {
    /// A changed output takes effect after the latency of the supply.
    pub fn pass_on(&mut self, before: Option<CoilSupply>, wanted: Option<CoilSupply>, plant: &Plant) {
        if wanted != before {
            self.underway.push_back((plant.now_s() + LATENCY_S, wanted));
        }
    }

    /// After one step: pending changes take effect, and a protection may switch the output off.
    pub fn step(&mut self, channel: &mut Channel, plant: &mut Plant) {
        while self.underway.front().is_some_and(|(due_s, _)| plant.now_s() >= *due_s) {
            plant.inputs.coil = self.underway.pop_front().and_then(|(_, supply)| supply);
        }
        let Some(supply) = plant.inputs.coil.filter(|_| channel.on) else { return };
        let volts = plant.brake.settled_a(Some(supply)) * plant.brake.coil_ohm();
        let (over_v, over_a) = (&mut channel.over_voltage, &mut channel.over_current);
        over_v.tripped |= over_v.enabled && volts > over_v.value;
        over_a.tripped |= over_a.enabled && plant.brake.coil_a() > over_a.value;
        if over_v.tripped || over_a.tripped {
            channel.on = false;
            self.underway.clear();
            plant.inputs.coil = None;
        }
    }
}

/// Voltage and current at the terminals with read-back noise. `free_v`: voltage of an output that is not wired.
pub fn measured(free_v: Option<f64>, plant: &Plant) -> (f64, f64) {
    let (volts, amperes) = match (free_v, plant.inputs.coil) {
        (Some(volts), _) => (volts, 0.0),
        (None, Some(supply)) => (plant.brake.settled_a(Some(supply)) * plant.brake.coil_ohm(), plant.brake.coil_a()),
        (None, None) => return (0.0, 0.0),
    };
    if free_v == Some(0.0) {
        return (0.0, 0.0);
    }
    let volts_noise = READBACK_NOISE_V * plant.noise_of(Signal::SupplyVoltage);
    let amperes_noise = READBACK_NOISE_A * plant.noise_of(Signal::SupplyCurrent);
    ((volts + volts_noise).max(0.0), (amperes + amperes_noise).max(0.0))
}

/// 1: current regulated, 2: voltage regulated, 0: off. An output that is not wired regulates its voltage.
pub fn held(on: bool, wired: bool, plant: &Plant) -> u32 {
    match plant.inputs.coil {
        _ if !on => 0,
        Some(supply) if wired && supply.current_a * plant.brake.coil_ohm() > supply.voltage_v => 2,
        _ if wired => 1,
        _ => 2,
    }
}

pub fn switch(text: &str) -> Option<bool> {
    match text.to_ascii_uppercase().as_str() {
        "ON" | "1" => Some(true),
        "OFF" | "0" => Some(false),
        _ => None,
    }
}
