//! A bench as it stands now.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum BenchState {
    Idle,
    Running,
    Paused,
    /// Drive torque goes off and the brake current to zero.
    Securing,
    /// By the software stop, until somebody resets it.
    Stopped,
    /// An instrument does not do what it should.
    Fault,
    /// The instruments could not be opened.
    Offline,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Bench {
    pub name: String,
    /// True where the instruments are simulated.
    pub simulated: bool,
    pub state: BenchState,
    /// Why no run may start until a person acknowledges.
    pub blocked: Option<Blocked>,
    /// The run in progress.
    pub run: Option<i64>,
    pub instruments: Vec<Instrument>,
    pub limits: Vec<Limit>,
    /// As they come in during the run that is on, or came in during the last one since the daemon began; before it, what the
    /// instruments tell in every run.
    pub channels: Vec<ChannelHealth>,
    pub constants: Constants,
    /// What was measured and is not yet durable.
    pub unstored: Option<Unstored>,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Unstored {
    pub rows: u64,
    /// Since when none of them was stored.
    #[schema(format = DateTime)]
    pub since: Option<String>,
    /// Why nothing can be stored, or so slowly. It is tried again until it is stored.
    pub fault: Option<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Blocked {
    /// By the software stop; otherwise it is not known whether the bench is safe.
    pub stopped: bool,
    pub reason: String,
    /// Who pressed the stop: name of the token, or `local`.
    pub by: Option<String>,
    #[schema(format = DateTime)]
    pub since: String,
    /// Otherwise it holds all the same, and is stored as soon as the disk takes it.
    pub stored: bool,
}

/// An entry of a bench's safety record, which is only appended to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SafetyEntry {
    /// The bench must not move from here on; otherwise a person has released it.
    pub blocked: bool,
    /// By the software stop.
    pub stopped: bool,
    pub reason: String,
    pub run: Option<i64>,
    /// Name of the token, or `local`; `null` where no person did it, or it was kept by an older version.
    pub by: Option<String>,
    #[schema(format = DateTime)]
    pub at: String,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Instrument {
    pub bench: String,
    /// `joint`, `torque_sensor`, `brake`, `reference_encoder`, `test_encoder`, `stage` or `thermometer`.
    pub role: String,
    pub name: String,
    pub driver: String,
    pub port: String,
    pub ready: bool,
    pub identity: Option<InstrumentIdentity>,
    /// What is wrong and what to do about it.
    pub fault: Option<String>,
    /// Since when it is not ready.
    #[schema(format = DateTime)]
    pub since: Option<String>,
    /// The last of what was wrong, newest first, what came back by itself too.
    pub faults: Vec<InstrumentFault>,
}

/// What was wrong with an instrument.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct InstrumentFault {
    #[schema(format = DateTime)]
    pub at: String,
    pub text: String,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct InstrumentIdentity {
    pub maker: String,
    pub model: String,
    pub serial: String,
    pub firmware: String,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Limit {
    pub quantity: String,
    pub unit: String,
    pub limit: f64,
    /// The newest reading, where a run is on.
    pub value: Option<f64>,
}

/// How a channel comes in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ChannelHealth {
    pub name: String,
    pub unit: Option<String>,
    /// New readings in a second of the bench's clock; one that is held counts once. `null` before the second.
    pub rate_hz: Option<f64>,
    /// When the last value was felt, by the daemon's clock.
    #[schema(format = DateTime)]
    pub at: Option<String>,
    /// How long ago that was when the bench was told of.
    pub age_s: Option<f64>,
    /// Samples of the run that did not come.
    pub dropped: u64,
}

/// Constants of the joint under test.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Constants {
    pub torque_constant_nm_per_a: f64,
    pub gear_ratio: f64,
    pub rotor_inertia_kg_m2: f64,
    pub brake_compliance_v: f64,
    pub brake_rated_current_a: f64,
    pub brake_rated_torque_nm: f64,
    /// The link may turn this far to either side; `null` where it is not limited.
    pub link_range_rad: Option<f64>,
}

/// A person's word that the bench was looked at and is safe.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Acknowledgement {
    /// What was found and done; kept with the bench.
    #[schema(min_length = 1)]
    pub reason: String,
}
