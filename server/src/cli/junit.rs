//! The JUnit report of a run: one test case for the run, and one for each requirement.

use super::arguments::Run as Arguments;
use super::exit::Exit;
use super::identify;
use super::outcome::{Found, ending, title};
use super::require::{Requirement, RequirementResult};
use crate::view::Run;

/// The run's test case is a failure if it did not complete or has no result, and an error if there is no run. The other
/// test cases are skipped if no run has completed.
pub fn junit(
    arguments: &Arguments,
    required: &[Requirement],
    ended: &Result<Run, Exit>,
    found: Option<&Found>,
    demands: &[(&Requirement, RequirementResult)],
) -> String {
    let procedure = title(arguments);
    let (suite, case, time_s) = match ended {
        Ok(Run { summary, .. }) => {
            (summary.bench.clone(), format!("{procedure} run {}", summary.id), summary.duration_s.unwrap_or(0.0))
        }
        Err(_) => ("jointbench".to_owned(), procedure, 0.0),
    };
    let outcome = match (ended, found) {
        (Err(exit), _) | (_, Some(Err(exit))) => Some(("error", exit.message.clone())),
        (_, Some(Ok(found))) if identify::ending(found).is_ok() => None,
        (_, Some(Ok(found))) => Some(("failure", identify::verdict(found))),
        (Ok(run), None) => Some(("failure", ending(run))),
    };
    let warnings = found.and_then(|found| found.as_ref().ok()).map(|found| found.result.warnings.join("\n"));
    let mut cases = vec![(case, time_s, outcome)];
    cases.extend(demands.iter().map(|(demand, kept)| {
        let outcome = match kept {
            RequirementResult::Pass(_) => None,
            RequirementResult::Fail(message)
            | RequirementResult::Marginal(message)
            | RequirementResult::Inconclusive(message) => Some(("failure", message.clone())),
            RequirementResult::Unknown(message) => Some(("error", message.clone())),
        };
        (demand.text.clone(), 0.0, outcome)
    }));
    if demands.is_empty() {
        let skipped = || Some(("skipped", "no run has completed, so this limit was not checked".to_owned()));
        cases.extend(required.iter().map(|demand| (demand.text.clone(), 0.0, skipped())));
    }
    let count =
        |kind: &str| cases.iter().filter(|(_, _, outcome)| outcome.as_ref().is_some_and(|o| o.0 == kind)).count();
    let suite = escape(&suite);
    let mut report = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n  <testsuite name=\"{suite}\" tests=\"{}\" \
         failures=\"{}\" errors=\"{}\" skipped=\"{}\" time=\"{time_s:.3}\">\n",
        cases.len(),
        count("failure"),
        count("error"),
        count("skipped"),
    );
    for (name, time_s, outcome) in &cases {
        let body = match outcome {
            Some((kind, message)) => format!("\n      <{kind} message=\"{}\"/>\n    ", escape(message)),
            None => String::new(),
        };
        report += &format!(
            "    <testcase classname=\"{suite}\" name=\"{}\" time=\"{time_s:.3}\">{body}</testcase>\n",
            escape(name)
        );
    }
    if let Some(warnings) = warnings.filter(|text| !text.is_empty()) {
        report += &format!("    <system-out>{}</system-out>\n", escape(&warnings));
    }
    report + "  </testsuite>\n</testsuites>\n"
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub fn asked(words: &[&str]) -> Arguments {
        use clap::Parser;
        #[derive(Parser)]
        struct Alone {
            #[command(flatten)]
            run: Arguments,
        }
        Alone::parse_from([&["run"], words].concat()).run
    }

    #[test]
    fn a_run_that_never_was_is_an_error_in_the_report() {
        let asked = asked(&["friction", "--require", "tau_c < 0.03 Nm", "--require", "c_v > 0 Nm·s/rad"]);
        let report = junit(&asked, &asked.require, &Err(Exit::bad_input("repeats = 0 < 1")), None, &[]);
        assert!(report.contains("tests=\"3\" failures=\"0\" errors=\"1\" skipped=\"2\""), "{report}");
        assert!(report.contains("<error message=\"repeats = 0 &lt; 1\"/>"), "{report}");
        let skipped = "name=\"tau_c &lt; 0.03 Nm\" time=\"0.000\">\n      <skipped message=\"no run has completed";
        assert!(report.contains(skipped), "{report}");
    }

    #[test]
    fn a_broken_limit_is_a_failure_of_its_own() {
        let demand: Requirement = "tau_c < 0.03 Nm".parse().unwrap();
        let demands = [(&demand, RequirementResult::Fail("message".to_owned()))];
        let report = junit(&asked(&["friction"]), &[], &Err(Exit::bad_input("no run")), None, &demands);
        assert!(report.contains("tests=\"2\" failures=\"1\" errors=\"1\" skipped=\"0\""), "{report}");
        assert!(report.contains("name=\"tau_c &lt; 0.03 Nm\""), "{report}");
    }

    #[test]
    fn markup_in_a_reason_stays_text() {
        assert_eq!(escape("a < b & \"c\""), "a &lt; b &amp; &quot;c&quot;");
    }
}
