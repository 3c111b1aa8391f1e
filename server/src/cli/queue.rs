//! `jointbench queue`: runs that wait for a bench, and test plans.

use super::arguments::{Queue, QueueCommand, UnitArguments};
use super::client::Client;
use super::exit::{Done, Exit};
use super::print::json_out;
use super::queue_entry::show;
use super::run::{choose_bench, unit};
use super::units::print_rows;
use super::{files, test_plan};
use crate::view::{Bench, BenchQueue, NewRun, NewTestPlan, ProceedIf, QueueEntry, QueuePriority, QueueState, word};
use serde::Deserialize;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

pub fn queue(arguments: &Queue) -> Done {
    let client = Client::new(&arguments.reach)?;
    let json = arguments.json;
    match arguments.command.as_ref().unwrap_or(&QueueCommand::List) {
        QueueCommand::List => list(&client, json),
        QueueCommand::Add { plan, bench, priority, wait, junit, unit } => {
            junit.iter().try_for_each(|path| files::writable(path))?;
            let plan = new_plan(&client, plan, bench.as_deref(), *priority, unit)?;
            let entries: Vec<QueueEntry> = client.post("/queue", &plan)?;
            if *wait || junit.is_some() {
                return test_plan::wait(&client, &entries, junit.as_deref(), json);
            }
            if json {
                return json_out(&entries);
            }
            entries.iter().try_for_each(|entry| show(&client, entry, false))
        }
        QueueCommand::Remove { entry } => changed(&client.delete(&format!("/queue/{entry}"))?, json),
        QueueCommand::Restore { entry } => changed(&client.post(&format!("/queue/{entry}/restore"), &())?, json),
        QueueCommand::Priority { entry, priority } => {
            let priority = QueuePriority { priority: *priority };
            changed(&client.put(&format!("/queue/{entry}/priority"), &priority)?, json)
        }
        QueueCommand::Pause { bench } => switch(&client, bench.as_deref(), "pause", json),
        QueueCommand::Resume { bench } => switch(&client, bench.as_deref(), "resume", json),
    }
}

fn list(client: &Client, json: bool) -> Done {
    let queues: Vec<BenchQueue> = client.get("/queue")?;
    if json {
        return json_out(&queues);
    }
    for BenchQueue { bench, paused, entries, left } in queues {
        let state: Bench = client.get(&format!("/bench/{bench}"))?;
        let on = state.run.map(|run| format!("run {run} in progress, ")).unwrap_or_default();
        let waiting = if entries.is_empty() { "no run waits".to_owned() } else { format!("{} waiting", entries.len()) };
        println!("{bench}: {on}{waiting}");
        if let Some(pause) = &paused {
            println!("paused: {}; `jointbench queue resume {bench}` starts the next run", pause.reason);
        }
        if !entries.is_empty() {
            print_rows(&HEAD, entries.iter().map(cells));
        }
        if !left.is_empty() {
            println!("left the queue, the newest first:");
            print_rows(&LEFT_HEAD, left.iter().take(MOST_LEFT).map(left_cells));
        }
    }
    Ok(())
}

const HEAD: [&str; 7] = ["entry", "procedure", "unit", "by", "priority", "takes", "starts in"];

fn cells(entry: &QueueEntry) -> [String; 7] {
    let procedure = &entry.request.procedure;
    let serial = entry.request.unit.as_ref().map(|unit| unit.serial.clone());
    [
        entry.id.to_string(),
        entry.plan.map_or_else(|| procedure.clone(), |plan| format!("{procedure} (plan {plan})")),
        serial.unwrap_or_else(|| "–".into()),
        entry.by.clone(),
        entry.priority.to_string(),
        format!("{:.0} s", entry.planned_s),
        entry.starts_in_s.map_or_else(|| "–".into(), |s| format!("{s:.0} s")),
    ]
}

/// Displayed entries that left a queue.
const MOST_LEFT: usize = 5;
const LEFT_HEAD: [&str; 4] = ["entry", "procedure", "unit", "outcome"];

fn left_cells(entry: &QueueEntry) -> [String; 4] {
    let [id, procedure, unit, ..] = cells(entry);
    let outcome = match (entry.run, entry.run_state) {
        (Some(run), Some(state)) => format!("run {run} is {}", word(state)),
        _ => word(entry.state),
    };
    let reason = entry.reason.as_ref().map(|reason| format!(": {reason}")).unwrap_or_default();
    [id, procedure, unit, outcome + &reason]
}

fn changed(entry: &QueueEntry, json: bool) -> Done {
    if json {
        return json_out(entry);
    }
    match entry.state {
        QueueState::Waiting => println!("queue entry {} waits with priority {}", entry.id, entry.priority),
        state => println!("queue entry {} is {}", entry.id, word(state)),
    }
    Ok(())
}

fn switch(client: &Client, bench: Option<&str>, how: &str, json: bool) -> Done {
    let bench = choose_bench(client, bench)?;
    let queue: BenchQueue = client.post(&format!("/bench/{bench}/queue/{how}"), &())?;
    if json {
        return json_out(&queue);
    }
    let state = if queue.paused.is_some() { "paused" } else { "active" };
    println!("the queue of {bench} is {state}: {} waiting", queue.entries.len());
    Ok(())
}

/// A test plan: bench, unit and operator are the same for all runs.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct PlanFile {
    #[serde(default)]
    proceed_if: ProceedIf,
    bench: Option<String>,
    run: Vec<PlannedRun>,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct PlannedRun {
    procedure: String,
    #[serde(default)]
    parameters: Map<String, Value>,
    /// Limits file, relative to the test plan.
    limits: Option<PathBuf>,
    note: Option<String>,
}

fn new_plan(
    client: &Client,
    path: &Path,
    bench: Option<&str>,
    priority: i32,
    tested: &UnitArguments,
) -> Result<NewTestPlan, Exit> {
    let file = plan_file(path, &files::read_short_text(path)?)?;
    let bench = choose_bench(client, bench.or(file.bench.as_deref()))?;
    let new = |run: PlannedRun| {
        let limits = run.limits.map(|limits| files::read_short_text(&path.with_file_name(limits))).transpose()?;
        Ok(NewRun {
            bench: bench.clone(),
            procedure: run.procedure,
            parameters: run.parameters,
            unit: unit(tested),
            operator: tested.operator.clone(),
            limits,
            note: run.note,
            ..NewRun::default()
        })
    };
    let runs = file.run.into_iter().map(new).collect::<Result<_, Exit>>()?;
    Ok(NewTestPlan { proceed_if: file.proceed_if, runs, priority })
}

fn plan_file(path: &Path, text: &str) -> Result<PlanFile, Exit> {
    let wrong = |fault: String| Exit::bad_input(format!("{}: {fault}", path.display()));
    match path.extension().is_some_and(|extension| extension == "json") {
        true => serde_json::from_str(text).map_err(|fault| wrong(fault.to_string())),
        false => toml::from_str(text).map_err(|fault| wrong(fault.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_is_the_same_in_toml_and_json() {
        let toml = "proceed_if = \"pass\"\n[[run]]\nprocedure = \"friction\"\nparameters = { repeats = 3 }\nlimits = \"l.toml\"";
        let json = r#"{"proceed_if": "pass", "run": [{"procedure": "friction", "parameters": {"repeats": 3}, "limits": "l.toml"}]}"#;
        let plan = plan_file(Path::new("plan.toml"), toml).unwrap();
        assert_eq!(plan, plan_file(Path::new("plan.json"), json).unwrap());
        assert_eq!((plan.proceed_if, plan.run[0].parameters["repeats"].as_i64()), (ProceedIf::Pass, Some(3)));
        let wrong = plan_file(Path::new("plan.toml"), "[[run]]\nprocedure = \"friction\"\nrepeats = 3").unwrap_err();
        assert!(
            wrong.code == 2 && wrong.message.contains("plan.toml") && wrong.message.contains("repeats"),
            "{}",
            wrong.message
        );
    }
}
