//! One output of a DP821A: its settings and protections.

use super::dp800_commands::Quantity;
use crate::sim::plant::CoilSupply;

#[derive(Debug, Clone, Copy)]
pub struct Protection {
    pub value: f64,
    pub enabled: bool,
    pub tripped: bool,
}

#[derive(Debug, Clone)]
pub struct Channel {
    pub label: &'static str,
    pub most_v: f64,
    pub most_a: f64,
    pub voltage_v: f64,
    pub current_a: f64,
    pub on: bool,
    pub over_voltage: Protection,
    pub over_current: Protection,
}

impl Channel {
    pub fn new(label: &'static str, most_v: f64, most_a: f64) -> Self {
        let protection = |most: f64| Protection { value: 1.05 * most, enabled: false, tripped: false };
        Self {
            label,
            most_v,
            most_a,
            voltage_v: 0.0,
            current_a: 0.0,
            on: false,
            over_voltage: protection(most_v),
            over_current: protection(most_a),
        }
    }

    pub fn protection(&mut self, quantity: Quantity) -> &mut Protection {
        match quantity {
            Quantity::Voltage => &mut self.over_voltage,
            Quantity::Current => &mut self.over_current,
        }
    }

    pub fn wanted(&self) -> Option<CoilSupply> {
        self.on.then_some(CoilSupply { current_a: self.current_a, voltage_v: self.voltage_v })
    }
}
