//! Instruments on real wires: transports, one module per protocol, one driver per instrument, and a mock bench that
//! answers on the same wires.
//!
//! Everything here is synchronous: a bench is one physical thing, and one thread owns the bench and its ports. A driver
//! holds one [`transport::Link`]. The link holds the port exclusively and gives every request its own deadline. After a
//! missing or garbled reply it refuses further use until the instrument is drained and identified again.
//!
//! The mock bench ([`sim`]) simulates instruments, not drivers. The firmware side of each protocol answers on
//! pseudo-terminals or TCP ports that any program may open, or inside the process for accelerated time. The true
//! parameters are never sent over the wire.
//!
//! The traffic of any link can be recorded ([`PortSettings::record`]) and replayed as an instrument ([`sim::Replay`]).

#![warn(missing_docs)]
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod driver;
mod instruments;
pub mod protocol;
pub mod sim;
pub mod transport;

pub use driver::{
    AdamSettings, AdamThermometer, DmmSettings, DmmTorqueSensor, GcsSettings, GcsStage, LorenzSensor, LorenzSettings,
    OdriveJoint, OdriveSettings, PumaAxis, PumaGains, PumaSettings, QsbCounter, QsbSettings, ScpiSettings, ScpiSource,
};
pub use instruments::{Asked, InstrumentSettings, Instruments, JointSettings, TorqueSensorSettings};
pub use sim::{Joint, MockBench, MockSettings, Replay};
pub use transport::{Address, PortSettings};
