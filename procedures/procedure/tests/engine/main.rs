//! The engine on a scripted bench: whatever happens, a run ends in the safe state and says what was reached.

mod controls;
mod currents;
mod fakes;
mod faults;
mod keeping;
mod ledger;
mod limits;
mod pauses;
mod securing;
mod warm_up;
mod warmth;
