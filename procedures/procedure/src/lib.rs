//! Procedures plan, the engine acts, and the guard checks every command.
//!
//! A [`Procedure`] converts checked parameters to a [`Plan`]: steps with set-points over time,
//! pure data that can be previewed. [`engine::run`] runs a plan on a bench, on one thread with one loop, and hands
//! rows and events to a [`Recorder`]. Every exit of a run, including a panic, leads to the safe state.

#![warn(missing_docs)]
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod bench_facts;
pub mod brake_model;
mod brake_timing;
pub mod catalogue;
mod column_names;
mod columns;
pub mod deferred_plan;
mod encoder_columns;
pub mod engine;
pub mod event;
mod findings;
mod guard;
pub mod identification;
pub mod in_memory_run;
mod menu;
pub mod parameter;
pub mod plan;
pub mod preview;
pub mod profile;
pub mod recorder;
pub mod reproduce;
pub mod resume;
pub mod stage_pose;
pub mod state;
pub mod steady;
pub mod thresholds;

pub use bench_facts::BenchFacts;
pub use brake_model::{BrakeModel, ComparedBrake};
pub use catalogue::{Procedure, catalogue, procedure};
pub use deferred_plan::DeferredPlan;
pub use engine::{RunEnd, Secured, run, secure};
pub use event::{Control, Demand, Event, EventKind, Safe};
pub use identification::Identification;
pub use menu::menu;
pub use plan::{Plan, PlanFault};
pub use preview::Preview;
pub use recorder::{Commit, Live, Progress, Recorder, RecorderFault, RunId};
pub use state::{Outcome, RunState, Transition};
