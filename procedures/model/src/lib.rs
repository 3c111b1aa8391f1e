//! The heart: effects, identification and diagnosis of joints, encoders, stiffness and brakes. Pure numbers, no I/O.

pub mod effect;
pub mod effects;
mod error;
mod report;
mod spec;
pub mod view;

pub use effect::{Effect, EffectInfo, ParameterInfo};
pub use effects::effects;
pub use error::ModelError;
pub use report::*;
pub use spec::{ModelSpec, Options};
