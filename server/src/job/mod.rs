//! Computations on whole runs, each in a process of its own.
//!
//! A fit needs memory and time by the size of its run, and a table that comes from outside may be made to need too much of
//! both. The daemon starts itself anew for each of them (`jointbench job`): with a limit to its memory, behind everything
//! else on the processor, and killed as soon as nobody waits for it any more. Such a process only reads the store. What is to
//! be kept it hands back, and the daemon keeps it in one transaction.
//!
//! ```text
//! stdin      one line, a request as JSON; then open for as long as somebody waits
//! stdout     one line, whether it is answered or refused; then the answer, as its job makes it
//! ```

mod inside;
mod lane;
mod process;
mod reply;

pub use inside::main;
pub use process::{Jobs, Streamed};

use crate::lab::{Alignment, ExportRequest, ImportRequest, Most, Offer};
use crate::view::{EffectTrial, Exclusion};
use jointbench_procedure::Lesson;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::time::Duration;

/// What is computed. Runs and models are named by their numbers in the store.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum Job {
    Fit {
        runs: Vec<i64>,
        effects: Vec<String>,
        excluded: Vec<Exclusion>,
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
    Compare {
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
    /// An exported model on a run, before it is taken in.
    EvaluateFile {
        file: serde_json::Value,
        run: i64,
    },
    TryEffect {
        trial: EffectTrial,
    },
    /// `step`: where the run ended, such as `step 3 of 41`, which only those know who know the bench.
    Identify {
        run: i64,
        step: Option<String>,
    },
    Beside {
        run: i64,
    },
    /// The model that a run of `brake_hysteresis` has identified.
    BrakeModel {
        run: i64,
    },
    /// What the steps left of an unfinished run learn from its measurement.
    Recall {
        run: i64,
        lesson: Lesson,
    },
    Statistics {
        run: i64,
        channels: Option<Vec<String>>,
        from_s: Option<f64>,
        to_s: Option<f64>,
    },
    Differences {
        runs: Vec<i64>,
        how: Alignment,
    },
    Derived {
        run: i64,
        formulas: Vec<String>,
        window: [Option<f64>; 2],
        most: Most,
    },
    Spectrum {
        run: i64,
        formula: String,
        window: [Option<f64>; 2],
    },
    Export(ExportRequest),
    /// Rows are laid down in a file; a file that was `uploaded` has closer bounds than one of the user's own.
    Import {
        request: ImportRequest,
        rows: PathBuf,
        uploaded: bool,
    },
    /// What a file holds, before it is taken in.
    Preview {
        request: ImportRequest,
        uploaded: bool,
    },
}

impl Job {
    /// Files wait for each other, not for computations: a slow reader of an export holds up no fit.
    fn moves_a_file(&self) -> bool {
        matches!(self, Job::Export(_) | Job::Import { .. } | Job::Preview { .. })
    }
}

/// What one computation may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Limits {
    /// Address space of its process.
    pub memory_bytes: u64,
    pub time: Duration,
}

pub const GIB: u64 = 1 << 30;

impl Default for Limits {
    fn default() -> Self {
        Limits { memory_bytes: 4 * GIB, time: Duration::from_secs(600) }
    }
}

/// What the process is told.
#[derive(Debug, Serialize, Deserialize)]
struct Request<J> {
    data: PathBuf,
    memory_bytes: u64,
    job: J,
}
