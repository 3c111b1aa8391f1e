//! `jointbench run`: a procedure on a running daemon.

use super::arguments::{Run as Arguments, UnitArguments};
use super::client::Client;
use super::exit::{Done, Exit};
use super::outcome::{Found, title};
use super::print::json_out;
use super::waiting::{lost, notify_on_interrupt, wait_at_most};
use super::{files, identify, queue_entry};
use crate::limits::{self, Case, CaseOutcome, Made, Measured, Outcome, Requirement};
use crate::view::{Bench, Identification, LimitOutcome, NewRun, Run, RunState, Unit, word};
use jointbench_procedure::procedure;
use serde_json::{Map, Value};
use std::path::Path;
use std::time::Duration;

pub fn run(arguments: &Arguments) -> Done {
    let client = Client::new(&arguments.reach)?;
    arguments.junit.iter().try_for_each(|path| files::writable(path))?;
    let new = limits_text(&client, arguments).and_then(|limits| new_run(&client, arguments, limits));
    if arguments.queue && !arguments.waits() {
        let entry = queue_entry::add(&client, &new?, arguments.key.as_deref())?;
        return queue_entry::show(&client, &entry, arguments.json);
    }
    let ended = new.and_then(|new| start(&client, arguments, new));
    let found = found(&client, &ended);
    let required: Vec<(&Requirement, Outcome)> = match (&ended, &found) {
        (Ok(run), Some(found)) => arguments.require.iter().map(|limit| (limit, check(limit, run, found))).collect(),
        _ => Vec::new(),
    };
    if let Some(path) = &arguments.junit {
        let cases = cases(&title(arguments), &ended, found.as_ref(), &arguments.require, &required);
        write_junit(path, &[(&ended, found.as_ref())], &cases)?;
    }
    let run = ended?;
    if arguments.json {
        json_out(&run)?;
    }
    conclude(&run, found.as_ref(), &required, arguments.json)
}

/// The result of a completed run.
pub(super) fn found(client: &Client, ended: &Result<Run, Exit>) -> Option<Found> {
    let completed = ended.as_ref().ok().filter(|run| run.summary.state == RunState::Completed)?;
    Some(client.get(&format!("/runs/{}/identification", completed.summary.id)))
}

/// Prints how a run ended and its result, unless `quiet`. Returns the exit of the command.
pub(super) fn conclude(run: &Run, found: Option<&Found>, required: &[(&Requirement, Outcome)], quiet: bool) -> Done {
    let message = if run.summary.state.is_final() { run.ending() } else { String::new() };
    if !quiet && !message.is_empty() {
        println!("{message}");
        if let Some(Ok(found)) = found {
            identify::print(found);
        }
    }
    match run.summary.state.is_final() && run.summary.state != RunState::Completed {
        true => Err(Exit::failed(if quiet { message } else { String::new() })),
        false => judge(found, required, quiet),
    }
}

/// The text of the limits file. A limit that does not apply or that the procedure cannot meet is refused before any
/// motion.
fn limits_text(client: &Client, arguments: &Arguments) -> Result<Option<String>, Exit> {
    let id = match (&arguments.procedure, arguments.continues) {
        (None, Some(before)) if !arguments.require.is_empty() => {
            client.get::<Run>(&format!("/runs/{before}"))?.summary.procedure
        }
        (id, _) => id.clone().unwrap_or_default(),
    };
    let wrong = |limit: &Requirement, why| Exit::bad_input(format!("'{}': {why}", limit.text));
    // The daemon refuses an unknown procedure.
    if let Some(procedure) = procedure(&id) {
        let finds = procedure.finds();
        arguments
            .require
            .iter()
            .try_for_each(|limit| limit.can_be_met_by(&id, &finds).map_err(|why| wrong(limit, why)))?;
    }
    let Some(path) = &arguments.limits else { return Ok(None) };
    let text = files::read_text(path)?;
    let unit = unit(&arguments.unit);
    limits::checked(&text, &Measured::new(unit.as_ref(), &id))
        .map_err(|fault| Exit::bad_input(format!("{}: {fault}", path.display())))?;
    Ok(Some(text))
}

/// The JUnit cases of a run: the run and its limits. The limits are skipped if it has not completed.
pub(super) fn cases(
    title: &str,
    ended: &Result<Run, Exit>,
    found: Option<&Found>,
    require: &[Requirement],
    required: &[(&Requirement, Outcome)],
) -> Vec<Case> {
    let found_case = found.map(|found| found.as_ref().map_err(|exit| exit.message.as_str()));
    let mut cases = vec![match ended {
        Ok(run) => limits::run_case(run, found_case),
        Err(exit) => Case { name: title.to_owned(), time_s: 0.0, outcome: CaseOutcome::Error(exit.message.clone()) },
    }];
    cases.extend(required.iter().map(|(limit, outcome)| limits::limit_case(&limit.text, outcome)));
    if let Some(Ok(found)) = found {
        cases.extend(found.limits.iter().flat_map(limits::cases_of));
    } else {
        let kept = ended.as_ref().ok().map_or(Ok(Vec::new()), limits::of_run);
        let unchecked = require.iter().filter(|_| required.is_empty()).chain(kept.iter().flatten());
        cases.extend(unchecked.map(|limit| limits::skipped_case(&limit.text)));
        let unread = |fault| Case { name: "limits".to_owned(), time_s: 0.0, outcome: CaseOutcome::Error(fault) };
        cases.extend(kept.err().map(unread));
    }
    cases
}

/// One suite, named after the bench, with the warnings of all results.
pub(super) fn write_junit(path: &Path, runs: &[(&Result<Run, Exit>, Option<&Found>)], cases: &[Case]) -> Done {
    let suite = runs.iter().find_map(|(ended, _)| Some(ended.as_ref().ok()?.summary.bench.clone()));
    let found = runs.iter().filter_map(|(_, found)| found.and_then(|found| found.as_ref().ok()));
    let warnings: Vec<String> = found.flat_map(|found| found.result.warnings.clone()).collect();
    files::write(path, limits::junit(suite.as_deref().unwrap_or("jointbench"), cases, &warnings).as_bytes())
}

fn check(limit: &Requirement, run: &Run, found: &Found) -> Outcome {
    match found {
        Ok(found) => {
            limit.check(Made { procedure: &run.summary.procedure, parameters: &run.parameters }, &found.result)
        }
        Err(exit) => Err(exit.message.clone()),
    }
}

/// Prints the result of each requirement; those of a limits file are part of the result. Exit codes in order of priority:
/// 2 for a requirement that cannot be checked, 1 for a failed result or an exceeded limit, 3 for no decision.
fn judge(found: Option<&Found>, required: &[(&Requirement, Outcome)], quiet: bool) -> Done {
    if !quiet {
        // A requirement that cannot be checked is reported with the exit code.
        let checked = required.iter().filter_map(|(_, outcome)| outcome.as_ref().ok());
        checked.for_each(|(outcome, message)| println!("{}: {message}", word(*outcome)));
    }
    let result = match found {
        None => Ok(()),
        Some(Ok(found)) => {
            let message = if quiet { found.line() } else { String::new() };
            identify::ending(found).map_err(|exit| Exit { message, ..exit })
        }
        Some(Err(exit)) => Err(exit.clone()),
    };
    let of_required = required.iter().map(|(_, outcome)| match outcome {
        Ok((outcome, message)) => {
            Exit { code: code(*outcome), message: if quiet { message.clone() } else { String::new() } }
        }
        Err(why) => Exit { code: BAD_INPUT, message: why.clone() },
    });
    let of_limits = found
        .and_then(|found| found.as_ref().ok())
        .and_then(of_limits)
        .map(|exit| Exit { message: if quiet { exit.message } else { String::new() }, ..exit });
    worst(&result.err().into_iter().chain(of_required).chain(of_limits).collect::<Vec<_>>())
}

/// The first exit of the code with the highest priority.
pub(super) fn worst(exits: &[Exit]) -> Done {
    match [2, 1, 3].into_iter().find_map(|code| exits.iter().find(|exit| exit.code == code)) {
        None => Ok(()),
        Some(worst) => Err(worst.clone()),
    }
}

/// Exit code of a requirement that cannot be checked.
const BAD_INPUT: u8 = 2;

/// Exit code of a limit.
fn code(outcome: LimitOutcome) -> u8 {
    match outcome {
        LimitOutcome::Pass => 0,
        LimitOutcome::Fail => 1,
        LimitOutcome::Marginal | LimitOutcome::Inconclusive => 3,
    }
}

/// The exit of the worst limit of the file.
fn of_limits(found: &Identification) -> Option<Exit> {
    let check = found.limits.as_ref().filter(|check| check.outcome != LimitOutcome::Pass)?;
    let message = check.limits.iter().find(|limit| limit.outcome == check.outcome)?.message.clone();
    Some(Exit { code: code(check.outcome), message })
}

/// The started run, or the ended run if the command waits.
fn start(client: &Client, arguments: &Arguments, new: NewRun) -> Result<Run, Exit> {
    let run: Run = match arguments.continues {
        Some(before) => {
            let run: Run = client.get(&format!("/runs/{before}"))?;
            if run.summary.state == RunState::Paused {
                return Err(Exit::bad_input(format!(
                    "run {before} is paused: resume it with `jointbench resume {before}`"
                )));
            }
            client.post(&format!("/runs/{before}/continue"), &())?
        }
        None if arguments.queue => {
            let entry = queue_entry::add(client, &new, arguments.key.as_deref())?;
            queue_entry::run_of(client, &entry, arguments.timeout)?
        }
        None => client.post("/runs", &new)?,
    };
    if !arguments.json {
        announce(client, &run, arguments.continues);
    }
    if !arguments.waits() {
        return Ok(run);
    }
    // The arguments are valid: later errors belong to the run.
    end_of(client, run.summary.id, arguments.timeout, arguments.lease)
}

pub(super) fn announce(client: &Client, run: &Run, continues: Option<i64>) {
    let (id, procedure, bench) = (run.summary.id, &run.summary.procedure, &run.summary.bench);
    let goes_on = continues.map(|before| format!(", continues run {before}")).unwrap_or_default();
    let unit = run.summary.unit.as_ref().map(|unit| format!(", unit {}", unit.line())).unwrap_or_default();
    println!("run {id}: {procedure} on {bench}{unit}{goes_on}  {}", client.page(&format!("/runs/{id}")));
}

/// The ended run.
pub(super) fn end_of(client: &Client, id: i64, limit: Option<Duration>, lease: Option<Duration>) -> Result<Run, Exit> {
    notify_on_interrupt(id, lease);
    wait_at_most(client, id, limit, lease).map_err(|exit| lost(id, client.is_answered(), &exit.message))
}

/// The requested run; of a continued run only its options.
fn new_run(client: &Client, arguments: &Arguments, limits: Option<String>) -> Result<NewRun, Exit> {
    if arguments.continues.is_some() {
        return Ok(NewRun::default());
    }
    Ok(NewRun {
        bench: choose_bench(client, arguments.bench.as_deref())?,
        procedure: arguments.procedure.clone().unwrap_or_default(),
        parameters: parameters(&arguments.set)?,
        unit: unit(&arguments.unit),
        operator: arguments.unit.operator.clone(),
        limits,
        note: arguments.note.clone(),
        lease_s: arguments.lease.map(|lease| lease.as_secs_f64()),
        queue: arguments.queue,
        priority: arguments.priority.unwrap_or_default(),
    })
}

/// The daemon checks the texts.
pub(super) fn unit(arguments: &UnitArguments) -> Option<Unit> {
    let UnitArguments { unit, part, revision, batch, operator: _ } = arguments;
    Some(Unit { serial: unit.clone()?, part: part.clone(), revision: revision.clone(), batch: batch.clone() })
}

pub(super) fn choose_bench(client: &Client, named: Option<&str>) -> Result<String, Exit> {
    if let Some(name) = named {
        return Ok(name.to_owned());
    }
    let benches: Vec<Bench> = client.get("/bench")?;
    match benches.as_slice() {
        [bench] => Ok(bench.name.clone()),
        [] => Err(Exit::bad_input("the daemon has no bench: restart it with --config BENCH.TOML")),
        several => {
            let names: Vec<&str> = several.iter().map(|bench| bench.name.as_str()).collect();
            Err(Exit::bad_input(format!("choose one with --bench: {}", names.join(", "))))
        }
    }
}

pub(super) fn parameters(set: &[String]) -> Result<Map<String, Value>, Exit> {
    let mut parameters = Map::new();
    for pair in set {
        let (name, value) = pair
            .split_once('=')
            .ok_or_else(|| Exit::bad_input(format!("--set {pair}: expected KEY=VALUE, such as --set repeats=3")))?;
        let value = match value.trim().strip_prefix('@') {
            Some(file) => serde_json::json!(
                jointbench_files::read_curve(Path::new(file)).map_err(|fault| Exit::bad_input(fault.cause()))?
            ),
            None => serde_json::from_str(value.trim()).unwrap_or_else(|_| Value::from(value.trim())),
        };
        parameters.insert(name.trim().to_owned(), value);
    }
    Ok(parameters)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::Identified;

    #[test]
    fn values_are_json_where_they_can_be() {
        let set = ["repeats=3".to_owned(), "note = warm oil".to_owned()];
        let parameters = parameters(&set).unwrap();
        assert_eq!(parameters["repeats"], 3);
        assert_eq!(parameters["note"], "warm oil");
        assert_eq!(super::parameters(&["repeats".to_owned()]).unwrap_err().code, 2);
        let file = tempfile::NamedTempFile::with_suffix(".csv").unwrap();
        std::fs::write(file.path(), "t,v\n0,0\n1,0.5\n").unwrap();
        let reference = |path: &std::path::Path| super::parameters(&[format!("reference=@{}", path.display())]);
        assert_eq!(reference(file.path()).unwrap()["reference"], serde_json::json!([[0.0, 0.0], [1.0, 0.5]]));
        assert_eq!(reference("missing.csv".as_ref()).unwrap_err().code, 2);
    }

    #[test]
    fn a_broken_limit_weighs_more_than_one_that_is_not_sure() {
        let limit: Requirement = "tau_c < 0.03 Nm".parse().unwrap();
        let message = || "message".to_owned();
        let code = |kept: &[Outcome]| {
            let required: Vec<_> = kept.iter().map(|kept| (&limit, kept.clone())).collect();
            judge(None, &required, true).err().map_or(0, |exit| exit.code)
        };
        assert_eq!(code(&[Ok((LimitOutcome::Pass, message()))]), 0);
        assert_eq!(code(&[Ok((LimitOutcome::Pass, message())), Ok((LimitOutcome::Marginal, message()))]), 3);
        assert_eq!(
            code(&[
                Ok((LimitOutcome::Marginal, message())),
                Ok((LimitOutcome::Fail, message())),
                Ok((LimitOutcome::Marginal, message()))
            ]),
            1
        );
        assert_eq!(code(&[Ok((LimitOutcome::Fail, message())), Err(message())]), 2);
    }

    #[test]
    fn what_was_not_identified_is_no_success() {
        let shown = |verdict| {
            let mut found = crate::limits::found();
            found.result.verdict = verdict;
            Ok(found)
        };
        let limit: Requirement = "tau_c < 0.03 Nm".parse().unwrap();
        let code = |found: Found, kept: Outcome| {
            judge(Some(&found), &[(&limit, kept)], true).err().map_or(0, |exit| exit.code)
        };
        let (yes, no) = (Ok((LimitOutcome::Pass, String::new())), Ok((LimitOutcome::Fail, String::new())));
        assert_eq!(code(shown(Identified::Identified), yes.clone()), 0);
        assert_eq!(code(shown(Identified::IdentifiedWithWarning), yes.clone()), 0);
        assert_eq!(code(shown(Identified::Inconclusive), yes.clone()), 3);
        assert_eq!(code(shown(Identified::Inconclusive), no), 1);
        assert_eq!(code(shown(Identified::Failed), yes.clone()), 1);
        assert_eq!(code(Err(Exit::failed("the daemon is gone")), yes), 1);
    }
}
