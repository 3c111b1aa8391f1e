//! The engine on a scripted bench: every run ends in the safe state and reports its result.

mod controls;
mod currents;
mod fakes;
mod faults;
mod keeping;
mod ledger;
mod limits;
mod pauses;
mod securing;
mod thermometer;
mod warm_up;
