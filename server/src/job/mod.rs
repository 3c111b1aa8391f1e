//! Computations on whole runs, each in a separate process.
//!
//! A fit needs memory and time in proportion to its run, and a table from outside can be made to need too much. The
//! daemon starts a process for each of them (`jointbench job`), with a memory limit and low priority. It kills the
//! process when no client waits for it. The process only reads the store; the daemon stores its results in one
//! transaction.
//!
//! ```text
//! stdin      one line, a request as JSON; then open while a client waits
//! stdout     one line, answer or refusal; then the answer of the job
//! ```

mod lane;
mod parameters;
mod process;
mod reply;

pub use parameters::{
    ARROW_STREAM, Alignment, ArchiveRequest, ArchivedFile, Encoding, ExportRequest, FileFormat, ImportRequest, Offer,
    PointLimit,
};
pub use process::{Jobs, Streamed};
pub(crate) use reply::{Head, Refusal};

use crate::view::{EffectTrial, Exclusion, ParameterSetting, Region};
use jointbench_procedure::DeferredPlan;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::time::Duration;

/// The computations. Runs and models are identified by their ids in the store.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum Job {
    Fit {
        runs: Vec<i64>,
        effects: Vec<String>,
        excluded: Vec<Exclusion>,
        settings: Vec<ParameterSetting>,
        offer: Option<Offer>,
    },
    Diagnose {
        model: i64,
        offer: Option<Offer>,
    },
    NextRun {
        diagnosis: i64,
        offer: Offer,
    },
    Residuals {
        model: i64,
    },
    /// Residual of these versions over the axis of the region.
    ResidualMap {
        models: Vec<i64>,
        region: Option<Region>,
    },
    CompareModels {
        first: i64,
        second: i64,
        run: i64,
    },
    Worth {
        model: i64,
    },
    WithEffect {
        model: i64,
        effect: String,
    },
    Evaluate {
        model: i64,
        run: i64,
    },
    /// An exported model on a run, before the import.
    EvaluateFile {
        file: serde_json::Value,
        run: i64,
    },
    TryEffect {
        trial: EffectTrial,
    },
    /// `step`: the step in which the run ended, such as `step 3 of 41`. Only a process with the bench knows it.
    Identify {
        run: i64,
        step: Option<String>,
    },
    OverlayModel {
        run: i64,
    },
    /// The model that a run of `brake_hysteresis` has identified.
    BrakeModel {
        run: i64,
    },
    /// The same with the error of the model, for comparison with another brake.
    ComparedBrake {
        run: i64,
    },
    /// The part of an unfinished run's measurement that its remaining steps need.
    Recall {
        run: i64,
        lesson: DeferredPlan,
    },
    Statistics {
        run: i64,
        channels: Option<Vec<String>>,
        from_s: Option<f64>,
        to_s: Option<f64>,
    },
    CompareRuns {
        runs: Vec<i64>,
        how: Alignment,
    },
    Derived {
        run: i64,
        formulas: Vec<String>,
        window: [Option<f64>; 2],
        most: PointLimit,
    },
    Spectrum {
        run: i64,
        formula: String,
        window: [Option<f64>; 2],
    },
    Export(ExportRequest),
    /// Writes the rows to a file. An `uploaded` file has stricter limits than a local file of the user.
    Import {
        request: ImportRequest,
        rows: PathBuf,
        uploaded: bool,
    },
    /// Content of a file before the import.
    Preview {
        request: ImportRequest,
        uploaded: bool,
    },
    /// Writes a file into the archive.
    Archive(ArchiveRequest),
    /// Compares a file of the archive with its digest.
    CheckArchived(ArchivedFile),
}

/// The queues of the computations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Queue {
    Computing,
    /// A slow reader of an export does not delay a fit.
    Moving,
    /// An archive that does not answer delays neither.
    Archiving,
}

impl Job {
    fn queue(&self) -> Queue {
        match self {
            Job::Export(_) | Job::Import { .. } | Job::Preview { .. } => Queue::Moving,
            Job::Archive(_) | Job::CheckArchived(_) => Queue::Archiving,
            _ => Queue::Computing,
        }
    }
}

/// Limits of one computation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Limits {
    /// Address space of its process.
    pub memory_bytes: u64,
    pub time: Duration,
    /// Whether it only runs when no other process needs the processor, because a bench runs in real time.
    pub is_idle: bool,
}

pub const GIB: u64 = 1 << 30;

impl Default for Limits {
    fn default() -> Self {
        Limits { memory_bytes: 4 * GIB, time: Duration::from_secs(600), is_idle: false }
    }
}

/// Input of the process.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Request<J> {
    pub data: PathBuf,
    pub limits: Limits,
    pub job: J,
}
