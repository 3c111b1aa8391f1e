//! `jointbench run`: a procedure on a running daemon.

use super::arguments::Run as Arguments;
use super::client::Client;
use super::exit::{Done, Exit};
use super::progress::RunProgress;
use crate::view::{Bench, NewRun, Run, RunState};
use serde_json::{Map, Value};
use std::time::Duration;

pub(super) const LOOK_EVERY: Duration = Duration::from_millis(250);

pub fn run(arguments: &Arguments) -> Done {
    let client = Client::new(&arguments.reach);
    let ended = start(&client, arguments);
    if let Some(path) = &arguments.junit {
        std::fs::write(path, junit(&arguments.procedure, &ended))
            .map_err(|fault| Exit::bad_input(format!("{}: {fault}", path.display())))?;
    }
    let run = ended?;
    let said = if is_over(run.summary.state) { ending(&run) } else { String::new() };
    if arguments.json {
        let text = serde_json::to_string_pretty(&run).map_err(|fault| Exit::failed(fault.to_string()))?;
        println!("{text}");
    } else if !said.is_empty() {
        println!("{said}");
    }
    match is_over(run.summary.state) && run.summary.state != RunState::Completed {
        true => Err(Exit::failed(if arguments.json { said } else { String::new() })),
        false => Ok(()),
    }
}

/// The run as it has just started, or as it ended where that is waited for.
fn start(client: &Client, arguments: &Arguments) -> Result<Run, Exit> {
    let new = NewRun {
        bench: choose_bench(client, arguments.bench.as_deref())?,
        procedure: arguments.procedure.clone(),
        parameters: parameters(&arguments.set)?,
    };
    let run: Run = client.post("/runs", &new)?;
    let id = run.summary.id;
    if !arguments.json {
        println!("run {id}: {} on {}  {}", new.procedure, new.bench, client.page(&format!("/runs/{id}")));
    }
    match arguments.wait || arguments.junit.is_some() {
        // The arguments were good: from here on it is the run that fails.
        true => wait(client, id).map_err(|exit| Exit::failed(format!("run {id} is lost from sight: {}", exit.said))),
        false => Ok(run),
    }
}

pub(super) fn choose_bench(client: &Client, named: Option<&str>) -> Result<String, Exit> {
    if let Some(name) = named {
        return Ok(name.to_owned());
    }
    let benches: Vec<Bench> = client.get("/bench")?;
    match benches.as_slice() {
        [bench] => Ok(bench.name.clone()),
        [] => Err(Exit::bad_input("the daemon has no bench: start it with --config BENCH.TOML")),
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
        let value = serde_json::from_str(value.trim()).unwrap_or_else(|_| Value::from(value.trim()));
        parameters.insert(name.trim().to_owned(), value);
    }
    Ok(parameters)
}

fn wait(client: &Client, id: i64) -> Result<Run, Exit> {
    let mut shown = RunProgress::begin();
    loop {
        let run: Run = client.get(&format!("/runs/{id}"))?;
        // The end is written in two strokes: the state with the last samples, then how the bench was secured.
        if is_over(run.summary.state) && run.summary.safe.is_some() {
            shown.end();
            return Ok(run);
        }
        if let Some(progress) = &run.progress {
            shown.show(progress);
        }
        std::thread::sleep(LOOK_EVERY);
    }
}

pub(super) fn is_over(state: RunState) -> bool {
    use RunState as S;
    matches!(state, S::Completed | S::Stopped | S::Aborted | S::Failed | S::Interrupted)
}

/// In the words of the API: `safe_verified`.
fn word(value: impl serde::Serialize) -> String {
    serde_json::to_value(value).ok().and_then(|value| value.as_str().map(str::to_owned)).unwrap_or_default()
}

pub(super) fn ending(run: &Run) -> String {
    let summary = &run.summary;
    let mut said = format!("run {} {}: {} rows", summary.id, word(summary.state), summary.rows);
    if let Some(duration_s) = summary.duration_s {
        said += &format!(" in {duration_s:.1} s of the bench");
    }
    if let Some(safe) = summary.safe {
        said += &format!(", bench {}", word(safe));
    }
    match &summary.reason {
        Some(reason) => said + ": " + reason,
        None => said,
    }
}

/// One test case: a failure where the run did not complete, an error where there is no run to tell of.
fn junit(procedure: &str, ended: &Result<Run, Exit>) -> String {
    let (suite, case, time_s) = match ended {
        Ok(Run { summary, .. }) => {
            let case = format!("{procedure} run {}", summary.id);
            (escape(&summary.bench), escape(&case), summary.duration_s.unwrap_or(0.0))
        }
        Err(_) => ("jointbench".to_owned(), escape(procedure), 0.0),
    };
    let (failures, errors, body) = match ended {
        Ok(run) if run.summary.state == RunState::Completed => (0, 0, String::new()),
        Ok(run) => (1, 0, format!("\n      <failure message=\"{}\"/>\n    ", escape(&ending(run)))),
        Err(exit) => (0, 1, format!("\n      <error message=\"{}\"/>\n    ", escape(&exit.said))),
    };
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n  <testsuite name=\"{suite}\" tests=\"1\" \
         failures=\"{failures}\" errors=\"{errors}\" time=\"{time_s:.3}\">\n    <testcase classname=\"{suite}\" \
         name=\"{case}\" time=\"{time_s:.3}\">{body}</testcase>\n  </testsuite>\n</testsuites>\n"
    )
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_json_where_they_can_be() {
        let set = ["repeats=3".to_owned(), "note = warm oil".to_owned()];
        let parameters = parameters(&set).unwrap();
        assert_eq!(parameters["repeats"], 3);
        assert_eq!(parameters["note"], "warm oil");
        assert_eq!(super::parameters(&["repeats".to_owned()]).unwrap_err().code, 2);
    }

    #[test]
    fn a_run_that_never_was_is_an_error_in_the_report() {
        let report = junit("friction", &Err(Exit::bad_input("repeats = 0 < 1")));
        assert!(
            report.contains("errors=\"1\"") && report.contains("<error message=\"repeats = 0 &lt; 1\"/>"),
            "{report}"
        );
    }

    #[test]
    fn markup_in_a_reason_stays_text() {
        assert_eq!(escape("a < b & \"c\""), "a &lt; b &amp; &quot;c&quot;");
    }
}
