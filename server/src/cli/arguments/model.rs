//! `jointbench model`.

use super::{Columns, StorePlace};
use clap::{Args, Subcommand};
use std::path::PathBuf;

const MODEL_EXAMPLES: &str = "\
Examples:
  jointbench fit RUN.csv --out model.json                   store a model
  jointbench model evaluate model.json OTHER.csv            its error on another run
  jointbench model compare old.json model.json RUN.csv      differences, and the error of both on this run
  jointbench model export model.json --format c -o joint.h  for a controller
  jointbench model import model.json --run 12               into the workbench, as a version of run 12";

#[derive(Debug, Args)]
#[command(after_help = MODEL_EXAMPLES)]
pub struct Model {
    #[command(subcommand)]
    pub command: ModelCommand,
}

#[derive(Debug, Subcommand)]
pub enum ModelCommand {
    /// Write a model for a controller or a simulator; the first comment names effects that the format cannot represent
    Export {
        /// Model file, written by `fit --out` or exported by the daemon
        #[arg(value_name = "MODEL.JSON")]
        model: PathBuf,
        #[arg(long, value_enum)]
        format: ModelFormat,
        /// File to write [default: standard output]
        #[arg(short, long, value_name = "FILE")]
        output: Option<PathBuf>,
    },
    /// Store a model as a version of a stored run, to view, compare, export and extend it
    ///
    /// Parameters are unchanged, and user-defined effects are included. The error is evaluated on the run. The
    /// destination is chosen as for `jointbench import`: the daemon whose address is given, otherwise the folder, or
    /// the daemon that uses the folder.
    Import {
        /// Model file, written by `fit --out` or exported as JSON
        #[arg(value_name = "MODEL.JSON")]
        model: PathBuf,
        /// Number of the run to evaluate the model on, of the same kind: `jointbench runs` lists them
        #[arg(long, value_name = "RUN")]
        run: i64,
        /// Print JSON
        #[arg(long)]
        json: bool,
        #[command(flatten)]
        store: StorePlace,
    },
    /// Evaluate the error of a model on a validation run
    Evaluate {
        #[arg(value_name = "MODEL.JSON")]
        model: PathBuf,
        #[arg(value_name = "RUN.CSV")]
        run: PathBuf,
        /// Meta file of the test conditions [default: as for fit]
        #[arg(long, value_name = "META.JSON")]
        meta: Option<PathBuf>,
        #[command(flatten)]
        columns: Columns,
        /// Print JSON
        #[arg(long)]
        json: bool,
    },
    /// Compare two models: effects, parameters, and the error of both on one run
    Compare {
        #[arg(value_name = "FIRST.JSON")]
        first: PathBuf,
        #[arg(value_name = "SECOND.JSON")]
        second: PathBuf,
        #[arg(value_name = "RUN.CSV")]
        run: PathBuf,
        /// Meta file of the test conditions [default: as for fit]
        #[arg(long, value_name = "META.JSON")]
        meta: Option<PathBuf>,
        #[command(flatten)]
        columns: Columns,
        /// Print JSON
        #[arg(long)]
        json: bool,
    },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum ModelFormat {
    /// The complete fit; the only format that can be imported
    Json,
    /// C99 header with one function, for a controller
    C,
    /// CSV look-up table over velocity and load, or over the signals of the model
    Lut,
    /// Attributes of a MuJoCo joint
    Mujoco,
    /// Attributes of a URDF joint
    Urdf,
}

impl From<ModelFormat> for jointbench_model::export::Format {
    fn from(format: ModelFormat) -> Self {
        match format {
            ModelFormat::Json => Self::Json,
            ModelFormat::C => Self::C,
            ModelFormat::Lut => Self::Table,
            ModelFormat::Mujoco => Self::Mujoco,
            ModelFormat::Urdf => Self::Urdf,
        }
    }
}
