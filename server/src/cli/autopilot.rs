//! `jointbench autopilot`: runs and diagnoses on a daemon, repeated until no effect is missing.

use super::arguments::Autopilot as Arguments;
use super::client::Client;
use super::exit::{Done, Exit};
use super::offline::decided;
use super::print::json_out;
use super::progress::RunProgress;
use super::run::{choose_bench, parameters};
use super::waiting::POLL_INTERVAL;
use crate::view::{Autopilot, AutopilotState, AutopilotStep, Diagnosis, Model, NewAutopilot, NewExperiment, Run};

pub fn autopilot(arguments: &Arguments) -> Done {
    let client = Client::new(&arguments.reach)?;
    let bench = choose_bench(&client, arguments.bench.as_deref())?;
    let mut autopilot: Autopilot = match arguments.after {
        Some(diagnosis) => client.post(&format!("/diagnoses/{diagnosis}/experiment"), &NewExperiment { bench })?,
        None => {
            let new = NewAutopilot {
                bench,
                runs: arguments.runs,
                bench_time_s: arguments.bench_time_s,
                procedure: arguments.procedure.clone(),
                parameters: parameters(&arguments.set)?,
                effects: arguments.model.as_ref().map(|list| list.split(',').map(|id| id.trim().to_owned()).collect()),
                max_effects: arguments.max_effects,
                from_run: None,
            };
            client.post("/autopilots", &new)?
        }
    };
    if !arguments.json {
        println!("autopilot {} on {}", autopilot.id, autopilot.bench);
    }
    if arguments.wait {
        autopilot = wait(&client, autopilot.id, !arguments.json)?;
    }
    if arguments.json {
        json_out(&autopilot)?;
    } else if autopilot.state.is_over() {
        conclude(&client, &autopilot)?;
    }
    ending(&client, &autopilot)
}

/// Waits for the end and prints each step when it is complete.
fn wait(client: &Client, id: i64, prints: bool) -> Result<Autopilot, Exit> {
    let mut printed = 0;
    let mut shown: Option<RunProgress> = None;
    loop {
        let autopilot: Autopilot = client.get(&format!("/autopilots/{id}"))?;
        for step in autopilot.steps.iter().skip(printed) {
            if let Some(shown) = shown.take() {
                shown.end();
            }
            if prints {
                println!("{}", line(step));
            }
        }
        printed = autopilot.steps.len();
        if autopilot.state.is_over() {
            return Ok(autopilot);
        }
        if let Some(run) = autopilot.runs.last() {
            let run: Run = client.get(&format!("/runs/{run}"))?;
            if let Some(progress) = run.progress.filter(|_| !run.summary.state.is_final()) {
                shown.get_or_insert_with(RunProgress::begin).show(&progress);
            }
        }
        std::thread::sleep(POLL_INTERVAL);
    }
}

fn line(step: &AutopilotStep) -> String {
    let model = step.model.map_or_else(String::new, |model| format!("model {model}: "));
    format!("{:>3}  {model}{}", step.sequence, step.text)
}

fn conclude(client: &Client, autopilot: &Autopilot) -> Done {
    println!();
    if let Some(id) = autopilot.model {
        let model: Model = client.get(&format!("/models/{id}"))?;
        println!("model {id}: {}", model.effects.join(" + "));
    }
    println!("{} runs, {:.0} s of bench time", autopilot.runs.len(), autopilot.bench_time_s);
    // An external reason is printed with the exit code.
    let by_itself = matches!(autopilot.state, AutopilotState::Finished | AutopilotState::BudgetSpent);
    if let Some(reason) = autopilot.reason.as_ref().filter(|_| by_itself) {
        println!("{reason}");
    }
    Ok(())
}

/// Has the exit code of its last diagnosis, like `discover`: a verdict without an effect is a result, too.
fn ending(client: &Client, autopilot: &Autopilot) -> Done {
    let reason = || autopilot.reason.clone().unwrap_or_default();
    match autopilot.state {
        AutopilotState::Running => Ok(()),
        AutopilotState::Finished => match autopilot.steps.iter().rev().find_map(|step| step.diagnosis) {
            None => Ok(()),
            Some(id) => decided(client.get::<Diagnosis>(&format!("/diagnoses/{id}"))?.finding.undecided.as_ref()),
        },
        AutopilotState::BudgetSpent => Err(Exit::undecided("the budget is used up before the model was decided")),
        AutopilotState::Stopped | AutopilotState::Failed | AutopilotState::Interrupted => Err(Exit::failed(reason())),
    }
}
