//! The heart: effects, identification and diagnosis of joints, encoders, stiffness and brakes. Pure numbers, no I/O.

#![warn(missing_docs)]

mod allocator;
pub mod channels;
mod compare;
mod diagnosis;
pub mod effect;
pub mod effects;
mod error;
mod experiment_design;
pub mod export;
mod fast_math;
mod fit;
pub mod formula;
mod hysteresis_operators;
mod inference;
pub mod linear;
mod prediction;
pub mod preprocess;
mod regression;
mod report;
mod residual_analysis;
mod residuals;
mod selection;
mod set_effect;
mod settings;
pub mod signal;
mod spec;
pub mod stats;
mod symbolic;
pub mod thresholds;
mod user_effects;
pub mod view;
pub mod words;

pub use allocator::one_heap;
pub use compare::compare;
pub use diagnosis::{diagnose, discover};
pub use effect::{Effect, EffectInfo, ParameterInfo};
pub use effects::effects;
pub use error::ModelError;
pub use experiment_design::{Choice, Next, Open, Stretch, next_run};
pub use fit::{evaluate, fit, fit_prepared};
pub use formula::FormulaFault;
pub use report::*;
pub use residual_analysis::maps::public::maps;
pub use residuals::residuals;
pub use spec::{ModelSpec, Options};
pub use user_effects::{Definition, UserEffect, UserParameter};
