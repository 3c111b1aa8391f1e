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
    /// By the software stop, until a person resets it.
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
    /// Why no run may start until a person resets the bench.
    pub blocked: Option<Blocked>,
    /// The run in progress.
    pub run: Option<i64>,
    pub instruments: Vec<Instrument>,
    pub limits: Vec<Limit>,
    /// Channels of the active run, or of the latest run since the start of the daemon; before the first run the
    /// channels of the instruments.
    pub channels: Vec<ChannelHealth>,
    pub constants: Constants,
    /// Recorded samples that are not yet stored.
    pub unstored: Option<Unstored>,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Unstored {
    pub rows: u64,
    /// Since when none of them was stored.
    #[schema(format = DateTime)]
    pub since: Option<String>,
    /// Why storage fails or is slow. Storage is retried until it succeeds.
    pub fault: Option<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Blocked {
    /// By the software stop; otherwise the safe state is not confirmed.
    pub stopped: bool,
    pub reason: String,
    /// Who pressed the stop: name of the token, or `local`.
    pub by: Option<String>,
    #[schema(format = DateTime)]
    pub since: String,
    /// If false, the block is active and is stored as soon as possible.
    pub stored: bool,
}

/// An entry of the safety record of a bench, which is append-only.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SafetyEntry {
    /// The bench is blocked from now on; otherwise a person has released it.
    pub blocked: bool,
    /// By the software stop.
    pub stopped: bool,
    pub reason: String,
    pub run: Option<i64>,
    /// Name of the token, or `local`; `null` for an automatic entry, or one of an older version.
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
    /// Cause and remedy.
    pub fault: Option<String>,
    /// Since when it is not ready.
    #[schema(format = DateTime)]
    pub since: Option<String>,
    /// Latest faults, newest first, including recovered ones.
    pub faults: Vec<InstrumentFault>,
}

/// A fault of an instrument.
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
    /// The latest reading during a run.
    pub value: Option<f64>,
}

/// State of an incoming channel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ChannelHealth {
    pub name: String,
    pub unit: Option<String>,
    /// New readings per second of bench time; a repeated value counts once. `null` before the second reading.
    pub rate_hz: Option<f64>,
    /// Time of the last value, by the clock of the daemon.
    #[schema(format = DateTime)]
    pub at: Option<String>,
    /// Age of the last value at the time of this message.
    pub age_s: Option<f64>,
    /// Missing samples of the run.
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
    /// Range of the link to either side; `null` if unlimited.
    pub link_range_rad: Option<f64>,
    /// Turns of the brake for each turn of the link; `null` without a load gear.
    pub load_gear_ratio: Option<f64>,
}

/// Confirmation by a person that the bench was inspected and is safe.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Acknowledgement {
    /// Findings and action taken; stored with the bench.
    #[schema(min_length = 1)]
    pub reason: String,
}
