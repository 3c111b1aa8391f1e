//! The command line.

mod arguments;

use crate::archive::{Archive, Selection};
use crate::compact::compact;
use crate::diagnose::{FleetDiagnosis, diagnose};
use crate::fit::{fit, model};
use crate::{Fault, diagnose as diagnosis, fit as fitting, query, report};
use arguments::{Arguments, Command, Common, Modelled};
use clap::Parser;
use serde::Serialize;
use std::io::Write;
use std::process::ExitCode;

/// Executes the command of the arguments. Exit codes: 0 success, 1 failure, 2 invalid arguments or files.
pub fn main() -> ExitCode {
    jointbench_model::one_heap();
    let Arguments { command } = Arguments::parse();
    match execute(&command).and_then(|text| print(&text)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(fault) => {
            eprintln!("jointbench-fleet: {fault}");
            ExitCode::from(fault.exit_code())
        }
    }
}

/// A closed pipe, as of `jointbench-fleet … | head`, is no fault.
fn print(text: &str) -> Result<(), Fault> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(fault) if fault.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Fault::Failed(format!("standard output: {fault}")))
        }
        _ => Ok(()),
    }
}

/// The output of a command.
fn execute(command: &Command) -> Result<String, Fault> {
    match command {
        Command::Query { sql, common } => {
            let (archive, selection) = opened(common, None)?;
            let found = query::answer(&archive, &selection, threads(common), sql)?;
            name_omitted(&found.session.means.damaged);
            name_omitted(&found.session.samples.damaged);
            if common.json { query::json(&found.batches).map(|json| json + "\n") } else { query::text(&found.batches) }
        }
        Command::Fit(Modelled { model: text, part, common }) => {
            let (archive, selection) = opened(common, part.as_deref())?;
            let found = fit(&archive, &selection, &model(text)?, threads(common))?;
            name_omitted(&found.omitted.damaged);
            written(common, &found, fitting::text)
        }
        Command::Diagnose(modelled) => written(&modelled.common, &diagnosed(modelled)?, diagnosis::text),
        Command::Report { modelled, out } => {
            let found = diagnosed(modelled)?;
            std::fs::write(out, report::page(&found))
                .map_err(|fault| Fault::Failed(format!("{}: {fault}", out.display())))?;
            written(&modelled.common, &found, |_| format!("Report: {}\n", out.display()))
        }
        Command::Compact { common } => {
            let (archive, selection) = opened(common, None)?;
            let done = in_threads(common, || compact(&archive, &selection))?;
            written(common, &done, |done| {
                let (before, after) = (done.files_before, done.files_after);
                format!("Means: {} runs, {before} files before, {after} files after\n", done.runs)
            })
        }
    }
}

fn diagnosed(Modelled { model: text, part, common }: &Modelled) -> Result<FleetDiagnosis, Fault> {
    let (archive, selection) = opened(common, part.as_deref())?;
    let found = in_threads(common, || diagnose(&archive, &selection, &model(text)?))?;
    name_omitted(&found.fit.omitted.damaged);
    Ok(found)
}

fn opened(common: &Common, part: Option<&str>) -> Result<(Archive, Selection), Fault> {
    let selection =
        Selection { part: part.map(str::to_owned), skip_damaged: common.skip_damaged, ..Selection::default() };
    Ok((Archive::open(&common.archive)?, selection))
}

fn threads(common: &Common) -> usize {
    common.threads.map_or_else(|| std::thread::available_parallelism().map_or(1, usize::from), usize::from)
}

/// Computes on the requested number of threads.
fn in_threads<T: Send>(common: &Common, compute: impl FnOnce() -> Result<T, Fault> + Send) -> Result<T, Fault> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads(common)).build();
    pool.map_err(|fault| Fault::Failed(format!("no threads: {fault}")))?.install(compute)
}

fn written<T: Serialize>(common: &Common, found: &T, text: impl FnOnce(&T) -> String) -> Result<String, Fault> {
    if !common.json {
        return Ok(text(found));
    }
    let json = serde_json::to_string_pretty(found).map_err(|fault| Fault::Failed(fault.to_string()))?;
    Ok(json + "\n")
}

fn name_omitted(damaged: &[crate::archive::Damaged]) {
    damaged.iter().for_each(|one| eprintln!("jointbench-fleet: omitted {}: {}", one.file, one.reason));
}
