//! Procedures decide, the engine acts, the guard has the last word.
//!
//! A [`Procedure`](catalogue::Procedure) turns checked parameters into a [`Plan`]: steps with set-points over time, pure
//! data that can be previewed. [`engine::run`] carries a plan out on a bench, one thread, one ordinary loop, and hands
//! rows and events to a [`Recorder`]. Every exit of a run, a panic too, passes the safe state.

pub mod catalogue;
mod columns;
pub mod conduct;
pub mod continuing;
mod encoder_columns;
pub mod engine;
pub mod event;
mod findings;
pub mod guard;
pub mod identification;
mod menu;
pub mod parameter;
pub mod place;
pub mod plan;
pub mod preview;
pub mod profile;
pub mod recorder;
pub mod reproduce;
pub mod state;
mod steady;

pub use catalogue::{Procedure, catalogue, procedure};
pub use engine::{RunEnd, Secured, run, secure};
pub use event::{Control, Demand, Event, EventKind, Safe};
pub use identification::Identification;
pub use menu::menu;
pub use plan::{BenchFacts, Lesson, Plan, PlanFault};
pub use preview::Preview;
pub use recorder::{Commit, Live, Progress, Recorder, RecorderFault, RunId};
pub use state::{Outcome, RunState, Transition};
