//! The command line. Offline commands work on files; the others on a data folder or a running daemon.

mod archive;
mod arguments;
mod autopilot;
mod backup;
mod check;
mod client;
mod control;
mod convert;
mod demo;
mod exit;
mod files;
mod identify;
mod job;
mod library;
mod log;
mod manual;
mod memory;
mod model;
mod notify;
mod offline;
mod outcome;
mod pdf;
mod ports;
mod print;
mod progress;
mod queue;
mod queue_entry;
mod reproduce;
mod run;
mod runs;
mod secrets;
mod serve;
mod simulate;
mod test_plan;
mod transfer;
mod units;
mod user_effects;
mod verify;
mod waiting;

use crate::bench::worker;
use arguments::{Arguments, Command};
use clap::Parser;
use std::process::ExitCode;

pub use exit::Exit;

/// Executes the command of the arguments. Exit codes: 0 success, 1 failed run or exceeded limit, 2 invalid arguments or
/// input, 3 no decision possible.
pub fn main() -> ExitCode {
    jointbench_model::one_heap();
    if let Err(exit) = secrets::hide_tokens() {
        return exit.print();
    }
    let arguments = Arguments::parse();
    // `jointbench fit … | head` ends without an error. Not for a process with a bench: the engine ends it.
    if !matches!(arguments.command, Command::Demo(_) | Command::Serve(_) | Command::Worker) {
        sigpipe::reset();
    }
    let default_level = if matches!(arguments.command, Command::Serve(_) | Command::Worker) { "info" } else { "warn" };
    log::start(arguments.log, default_level);
    let done = match arguments.command {
        Command::Job => return job::main(),
        Command::Demo(arguments) => demo::demo(arguments),
        Command::Serve(arguments) => serve::serve(arguments),
        Command::Worker => worker::serve().map_err(|fault| Exit::failed(fault.to_string())),
        Command::Check(arguments) => check::check(&arguments),
        Command::Ports(arguments) => ports::ports(&arguments),
        Command::Procedures(arguments) => library::procedures(arguments.id.as_deref()),
        Command::Effects(arguments) => library::effects(arguments.id.as_deref()),
        Command::Run(arguments) => run::run(&arguments),
        Command::Stop(arguments) => control::stop(&arguments),
        Command::Pause(arguments) => control::pause(&arguments),
        Command::Resume(arguments) => control::resume(&arguments),
        Command::Reset(arguments) => control::reset(&arguments),
        Command::ServoMemory(arguments) => memory::memory(&arguments),
        Command::Queue(arguments) => queue::queue(&arguments),
        Command::Notify(arguments) => notify::notify(&arguments),
        Command::Archive(arguments) => archive::archive(&arguments),
        Command::Runs(arguments) => runs::runs(&arguments),
        Command::Units(arguments) => units::units(&arguments),
        Command::Autopilot(arguments) => autopilot::autopilot(&arguments),
        Command::Diagnose(arguments) => offline::diagnose(&arguments),
        Command::Discover(arguments) => offline::discover(&arguments),
        Command::Fit(arguments) => offline::fit(&arguments),
        Command::Model(arguments) => model::model(&arguments),
        Command::Import(arguments) => transfer::import(&arguments),
        Command::Export(arguments) => transfer::export(&arguments),
        Command::Convert(arguments) => convert::convert(&arguments),
        Command::Identify(arguments) => identify::identify(&arguments),
        Command::Report(arguments) => identify::report(&arguments),
        Command::Backup(arguments) => backup::backup(&arguments),
        Command::Restore(arguments) => backup::restore(&arguments),
        Command::Verify(arguments) => verify::verify(&arguments),
        Command::Reproduce(arguments) => reproduce::reproduce(&arguments),
        Command::Simulate(arguments) => simulate::simulate(&arguments),
        Command::Completions { shell } => manual::completions(shell),
        Command::Man { folder } => manual::pages(&folder),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(exit) => exit.print(),
    }
}
