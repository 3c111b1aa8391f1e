//! `jointbench model`.

use super::{Columns, StorePlace};
use clap::{Args, Subcommand};
use std::path::PathBuf;

const MODEL_EXAMPLES: &str = "\
  jointbench fit RUN.csv --out model.json                   a model to keep
  jointbench model evaluate model.json OTHER.csv            its error on another run
  jointbench model compare old.json model.json RUN.csv      what has changed, and which is better there
  jointbench model export model.json --format c -o joint.h  for a controller
  jointbench model import model.json --run 12               into the workbench, beside the models of run 12";

#[derive(Debug, Args)]
#[command(after_help = MODEL_EXAMPLES)]
pub struct Model {
    #[command(subcommand)]
    pub command: ModelCommand,
}

#[derive(Debug, Subcommand)]
pub enum ModelCommand {
    /// Write a model for a controller or a simulator; what the format cannot hold is named in its first comment
    Export {
        /// What `fit --out` or the daemon's export has written
        #[arg(value_name = "MODEL.JSON")]
        model: PathBuf,
        #[arg(long, value_enum)]
        format: ModelFormat,
        /// File to write [default: standard output]
        #[arg(short, long, value_name = "FILE")]
        output: Option<PathBuf>,
    },
    /// Keep a model as a version of a stored run, to see, compare and export it there and to go on from it
    ///
    /// Its parameters stay as they are, and effects that a user wrote come with it. Its error becomes that on the run. As with
    /// `jointbench import` it goes to the daemon whose address is given, else to the folder, or to the daemon that has the folder.
    Import {
        /// What `fit --out` or an export as JSON has written
        #[arg(value_name = "MODEL.JSON")]
        model: PathBuf,
        /// Number of the run that it is held against, of the model's kind: `jointbench runs` lists them
        #[arg(long, value_name = "RUN")]
        run: i64,
        /// Print JSON
        #[arg(long)]
        json: bool,
        #[command(flatten)]
        store: StorePlace,
    },
    /// Tell the error of a model on a run that took no part in its fit
    Evaluate {
        #[arg(value_name = "MODEL.JSON")]
        model: PathBuf,
        #[arg(value_name = "RUN.CSV")]
        run: PathBuf,
        /// Facts about the set-up [default: as for fit]
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
        /// Facts about the set-up [default: as for fit]
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
    /// The complete fit; the only one that can be read again
    Json,
    /// C99 header with one function, for a controller
    C,
    /// CSV table over velocity and load, or what the model depends on
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
