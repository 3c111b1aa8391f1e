//! The mock bench: simulated instruments on real wires over one simulated plant.
//!
//! The firmware of each instrument answers on a pseudo-terminal (loopback TCP where there is none, or on request), in
//! its own thread, over one shared plant. Time is stepped: it advances only in [`Clock::sleep_until_s`], in fixed
//! substeps of the drive's control period. Noise is a function of seed, signal and time, so the same seed and the same
//! conversation give the same bytes.
//!
//! The plant shares no formula with the models of the project. Only [`MockBench::truth`] returns its hidden parameters;
//! they are never sent over a wire.

mod bench;
mod clock;
mod data_sheet;
mod firmware;
mod plant;
mod port;
#[cfg(unix)]
mod pty;
mod replay;
mod rig;
mod trouble;
mod wire;

pub use bench::{ENCODER_COUNTS, MockBench, MockError, MockSettings, Transport};
pub use data_sheet::{Joint, Load};
pub use plant::{EncoderTruth, HIDDEN_EFFECTS, HiddenEffect, Truth};
pub use replay::Replay;
pub use rig::{MockInstrument, Supply};
pub use trouble::{PlannedTrouble, Trouble};

#[cfg(doc)]
use jointbench_instrument::Clock;
