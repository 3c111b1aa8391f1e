//! Parameters of the computations.

use crate::config::ArchiveContent;
use jointbench_files::Choices;
use jointbench_instrument::RunTable;
use jointbench_procedure::BenchFacts;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::path::PathBuf;
use utoipa::ToSchema;

/// Media type of the Arrow IPC streaming format.
pub const ARROW_STREAM: &str = "application/vnd.apache.arrow.stream";

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum FileFormat {
    Csv,
    Parquet,
    /// For MATLAB, Octave and SciPy; out only
    Mat,
}

impl FileFormat {
    pub fn extension(self) -> &'static str {
        match self {
            FileFormat::Csv => "csv",
            FileFormat::Parquet => "parquet",
            FileFormat::Mat => "mat",
        }
    }

    pub fn media_type(self) -> &'static str {
        match self {
            FileFormat::Csv => "text/csv; charset=utf-8",
            FileFormat::Parquet => "application/vnd.apache.parquet",
            FileFormat::Mat => "application/x-matlab-data",
        }
    }
}

/// How the rows of a run are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Encoding {
    File(FileFormat),
    /// The Arrow IPC streaming format, for programs that read while it is written.
    ArrowStream,
}

impl Encoding {
    pub fn media_type(self) -> &'static str {
        match self {
            Encoding::File(format) => format.media_type(),
            Encoding::ArrowStream => ARROW_STREAM,
        }
    }
}

/// Export of a run, or of a section of it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ExportRequest {
    pub run: i64,
    pub encoding: Encoding,
    /// All channels if `None`.
    pub channels: Option<Vec<String>>,
    /// On the run's clock; default: the first row.
    pub from_s: Option<f64>,
    pub to_s: Option<f64>,
    /// Prevents that a spreadsheet reads a column name of a CSV file as a formula.
    pub spreadsheet_safe: bool,
}

/// A table of a run, to be written to the archive and read back.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ArchiveRequest {
    pub run: i64,
    pub content: ArchiveContent,
    pub folder: String,
}

/// A file of the archive, to be compared with its digest.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ArchivedFile {
    pub folder: String,
    pub path: String,
    pub sha256: String,
}

/// A measured file and the data needed to read it.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct ImportRequest {
    /// Name of the run; default: name of the file.
    pub name: Option<String>,
    /// Determines the format, and appears in messages.
    pub file_name: String,
    /// Path of the data.
    pub file: PathBuf,
    pub meta: Option<String>,
    pub choices: Choices,
}

/// A bench with the parameters of its runs so far.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Offer {
    pub bench: BenchFacts,
    pub parameters: Map<String, Value>,
}

impl Offer {
    /// Without a bench: the conditions that the run covers.
    pub fn shown_by(run: &RunTable) -> Self {
        Self { bench: BenchFacts::shown_by(run), parameters: Map::new() }
    }
}

/// The compared channel and the alignment axis.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Alignment {
    pub channel: String,
    pub by: String,
    /// The event that is the zero of time.
    pub from: Option<String>,
}

/// Limit of the returned points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum PointLimit {
    /// Smallest and largest value of each pixel, so that a spike of one sample remains visible.
    Pixels(u32),
    /// Unchanged rows, evenly selected.
    Rows(u32),
}
