//! Bench descriptions: raw values are checked once during parsing.

mod archive;
mod check;
mod error;
mod figures;
mod instruments;
mod notify;
mod raw;
mod secret;
#[cfg(test)]
mod tests;
mod values;

pub use archive::{Archive, ArchiveContent, NO_S3, S3};
pub use error::{ConfigError, ConfigErrors};
pub use notify::{Channel, Notify, NotifyEvent, NotifyTarget, Server, SigningKey};
pub use secret::{Secret, read_secret};

use jiff::civil::Date;
use jointbench_devices::sim::{ENCODER_COUNTS, MockInstrument};
use jointbench_devices::{InstrumentSettings, JointSettings, MockSettings, TorqueSensorSettings};
use jointbench_instrument::bench::JointConstants;
use jointbench_instrument::roles::SetpointInterval;
use jointbench_instrument::spelling::nearest;
use jointbench_instrument::{Limits, TorsionLimit};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Ready-made descriptions, also as templates.
pub const READY_MADE: [(&str, &str); 8] = [
    ("joint-a-mock", include_str!("../../descriptions/joint-a-mock.toml")),
    ("joint-b-mock", include_str!("../../descriptions/joint-b-mock.toml")),
    ("encoder-bench-mock", include_str!("../../descriptions/encoder-bench-mock.toml")),
    ("puma-mock", include_str!("../../descriptions/puma-mock.toml")),
    ("joint-a", include_str!("../../descriptions/joint-a.toml")),
    ("joint-b", include_str!("../../descriptions/joint-b.toml")),
    ("encoder-bench", include_str!("../../descriptions/encoder-bench.toml")),
    ("puma", include_str!("../../descriptions/puma.toml")),
];

/// A checked file.
#[derive(Debug, Clone)]
pub struct Description {
    pub benches: Vec<BenchDescription>,
    pub notify: Notify,
    pub archive: Option<Archive>,
}

/// A checked bench.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct BenchDescription {
    pub name: String,
    pub source: Source,
    pub limits: Limits,
    /// Monitor of the joint's torsion, if it is switched on.
    pub torsion: Option<TorsionLimit>,
    pub constants: JointConstants,
    /// Calibration dates of the instruments, by role.
    pub calibrated: Vec<(String, Date)>,
    /// Each time the instruments are opened, their traffic is recorded in a new subfolder.
    pub record: Option<PathBuf>,
    /// Original text for the provenance of its runs, without other benches of the file and without targets of notifications.
    pub text: String,
}

/// Source of the instruments.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum Source {
    Mock(MockSettings),
    Hardware(Box<InstrumentSettings>),
}

impl Source {
    /// Whether the bench measures the torque of the joint and the positions of motor and link.
    pub fn measures_torsion(&self) -> bool {
        match self {
            Source::Mock(settings) => settings.has(MockInstrument::TorqueSensor),
            Source::Hardware(settings) => {
                let link_encoder = matches!(&settings.joint, JointSettings::Odrive(odrive) if odrive.link_encoder);
                settings.torque_sensor.is_some() && link_encoder
            }
        }
    }
}

/// Properties of a bench that determine which procedures it can run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Has {
    pub torque_sensor: bool,
    /// The torque sensor has two ranges and measures both at the same time.
    pub two_ranges: bool,
    pub brake: bool,
    /// Counts per turn: reference encoder and encoder under test.
    pub encoder_counts: Option<[f64; 2]>,
    pub stage: bool,
    /// Motor current per volt, if it is measured as the voltage at a shunt.
    pub amperes_per_volt: Option<f64>,
    /// Interpolation of position set-points, if the joint's drive accepts positions.
    pub setpoint_interval: Option<SetpointInterval>,
    /// The joint's drive accepts a motor current in addition to a velocity.
    pub feeds_forward: bool,
}

impl BenchDescription {
    /// Whether the bench runs in real time: with real instruments, or as a simulation at their pace.
    pub fn is_real_time(&self) -> bool {
        match &self.source {
            Source::Mock(settings) => settings.pace.is_some_and(|pace| pace <= 1.0),
            Source::Hardware(_) => true,
        }
    }

    /// A mock bench with the constants and limits of its joint's data sheet.
    pub fn mock(name: &str, settings: MockSettings) -> Self {
        Self {
            name: name.to_owned(),
            limits: settings.limits(),
            torsion: None,
            constants: settings.constants(),
            source: Source::Mock(settings),
            calibrated: Vec::new(),
            record: None,
            text: String::new(),
        }
    }

    pub fn is_simulated(&self) -> bool {
        matches!(self.source, Source::Mock(_))
    }

    /// Bench seconds per second of real time; `None` if it runs as fast as possible.
    pub fn pace(&self) -> Option<f64> {
        match &self.source {
            Source::Mock(settings) => settings.pace,
            Source::Hardware(_) => Some(1.0),
        }
    }

    pub fn has(&self) -> Has {
        match &self.source {
            Source::Mock(settings) => Has {
                torque_sensor: settings.has(MockInstrument::TorqueSensor),
                two_ranges: settings.has(MockInstrument::TorqueSensor),
                brake: settings.has(MockInstrument::Brake),
                encoder_counts: (settings.has(MockInstrument::CounterS1) && settings.has(MockInstrument::CounterS2))
                    .then_some(ENCODER_COUNTS.map(f64::from)),
                stage: settings.has(MockInstrument::Stage),
                amperes_per_volt: settings.amperes_per_volt(),
                setpoint_interval: settings.setpoint_interval(),
                feeds_forward: settings.feeds_forward(),
            },
            Source::Hardware(settings) => Has {
                torque_sensor: settings.torque_sensor.is_some(),
                two_ranges: matches!(settings.torque_sensor, Some(TorqueSensorSettings::Lorenz(_))),
                brake: settings.brake.is_some(),
                encoder_counts: settings
                    .reference_encoder
                    .as_ref()
                    .zip(settings.test_encoder.as_ref())
                    .map(|(reference, test)| [reference, test].map(|counter| f64::from(counter.counts_per_turn))),
                stage: settings.stage.is_some(),
                amperes_per_volt: settings.joint.amperes_per_volt(),
                setpoint_interval: settings.joint.setpoint_interval(),
                feeds_forward: settings.joint.feeds_forward(),
            },
        }
    }

    pub fn seed(&self) -> Option<u64> {
        match &self.source {
            Source::Mock(settings) => Some(settings.seed),
            Source::Hardware(_) => None,
        }
    }
}

/// Reads a description. Reports every error with line and remedy.
pub fn read(path: &Path) -> Result<Description, ConfigErrors> {
    let file = path.display().to_string();
    match std::fs::read_to_string(path) {
        Ok(text) => parse(&file, &text),
        Err(fault) => Err(ConfigErrors { errors: vec![ConfigError { line: None, what: unread(&file, &fault) }], file }),
    }
}

/// Message about an unknown description, with the known names.
pub fn unread(name: &str, fault: &std::io::Error) -> String {
    let ready_made = READY_MADE.map(|(name, _)| name);
    let meant = nearest(name, ready_made).map(|near| format!("did you mean {near}? ")).unwrap_or_default();
    let why = match fault.kind() {
        std::io::ErrorKind::NotFound => "file not found".to_owned(),
        _ => format!("cannot be read ({fault})"),
    };
    format!("{why}: {meant}give the path of a bench description, or a built-in one: {}", ready_made.join(", "))
}

/// `file` is the name in messages.
pub fn parse(file: &str, text: &str) -> Result<Description, ConfigErrors> {
    check::check(file, text)
}
