//! The heart: effects, identification and diagnosis of joints, encoders, stiffness and brakes. Pure numbers, no I/O.

mod assembly;
mod diagnose;
pub mod effect;
pub mod effects;
mod error;
mod explore;
mod fit;
mod floor;
pub mod formula;
mod intervals;
mod linear;
mod maps;
mod memory;
mod own;
mod pieces;
pub mod prepare;
mod report;
mod residuals;
mod select;
mod spec;
mod terms;
pub mod transfer;
pub mod view;
mod words;

pub use diagnose::{diagnose, discover};
pub use effect::{Effect, EffectInfo, ParameterInfo};
pub use effects::effects;
pub use error::ModelError;
pub use fit::{evaluate, fit};
pub use formula::FormulaFault;
pub use maps::maps;
pub use own::{Definition, OwnEffect, OwnParameter};
pub use report::*;
pub use residuals::residuals;
pub use spec::{ModelSpec, Options};
