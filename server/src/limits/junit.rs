//! The JUnit report of a run: one test case for the run, and one for each limit.

use super::Outcome;
use crate::view::{Identification, LimitCheck, LimitOutcome, Run, RunState};

/// Outcome of a test case, with its message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CaseOutcome {
    Passed,
    Failure(String),
    Error(String),
    Skipped(String),
}

impl CaseOutcome {
    fn element(&self) -> Option<(&'static str, &str)> {
        match self {
            Self::Passed => None,
            Self::Failure(message) => Some(("failure", message)),
            Self::Error(message) => Some(("error", message)),
            Self::Skipped(message) => Some(("skipped", message)),
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    pub name: String,
    pub time_s: f64,
    pub outcome: CaseOutcome,
}

/// The case of a run: a failure if it did not complete or was not identified, an error without a result.
pub fn run_case(run: &Run, found: Option<Result<&Identification, &str>>) -> Case {
    let summary = &run.summary;
    let outcome = match found {
        Some(Err(message)) => CaseOutcome::Error(message.to_owned()),
        Some(Ok(found)) if found.result.verdict.is_identified() => CaseOutcome::Passed,
        Some(Ok(found)) => CaseOutcome::Failure(found.line()),
        None if summary.state == RunState::Completed => CaseOutcome::Passed,
        None => CaseOutcome::Failure(run.ending()),
    };
    let name = format!("{} run {}", summary.procedure, summary.id);
    Case { name, time_s: summary.duration_s.unwrap_or(0.0), outcome }
}

/// The case of a limit: a failure unless it passes, an error if it cannot be checked.
pub fn limit_case(limit: &str, outcome: &Outcome) -> Case {
    let outcome = match outcome {
        Ok((LimitOutcome::Pass, _)) => CaseOutcome::Passed,
        Ok((_, message)) => CaseOutcome::Failure(message.clone()),
        Err(why) => CaseOutcome::Error(why.clone()),
    };
    Case { name: limit.to_owned(), time_s: 0.0, outcome }
}

/// The cases of the limits that are kept with a run.
pub fn cases_of(check: &LimitCheck) -> impl Iterator<Item = Case> {
    check.limits.iter().map(|limit| limit_case(&limit.text, &Ok((limit.outcome, limit.message.clone()))))
}

/// The case of a limit whose run has no result.
pub fn skipped_case(limit: &str) -> Case {
    let why = "no run has completed, so this limit was not checked".to_owned();
    Case { name: limit.to_owned(), time_s: 0.0, outcome: CaseOutcome::Skipped(why) }
}

pub fn junit(suite: &str, cases: &[Case], warnings: &[String]) -> String {
    let count = |kind: &str| {
        cases.iter().filter(|case| case.outcome.element().is_some_and(|(element, _)| element == kind)).count()
    };
    let time_s: f64 = cases.iter().map(|case| case.time_s).sum();
    let suite = escape(suite);
    let mut report = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n  <testsuite name=\"{suite}\" tests=\"{}\" \
         failures=\"{}\" errors=\"{}\" skipped=\"{}\" time=\"{time_s:.3}\">\n",
        cases.len(),
        count("failure"),
        count("error"),
        count("skipped"),
    );
    for Case { name, time_s, outcome } in cases {
        let body = match outcome.element() {
            Some((kind, message)) => format!("\n      <{kind} message=\"{}\"/>\n    ", escape(message)),
            None => String::new(),
        };
        report += &format!(
            "    <testcase classname=\"{suite}\" name=\"{}\" time=\"{time_s:.3}\">{body}</testcase>\n",
            escape(name)
        );
    }
    if !warnings.is_empty() {
        report += &format!("    <system-out>{}</system-out>\n", escape(&warnings.join("\n")));
    }
    report + "  </testsuite>\n</testsuites>\n"
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(name: &str, outcome: CaseOutcome) -> Case {
        Case { name: name.to_owned(), time_s: 0.0, outcome }
    }

    #[test]
    fn a_run_that_never_was_is_an_error_in_the_report() {
        let error = CaseOutcome::Error("repeats = 0 < 1".to_owned());
        let cases = [case("friction", error), skipped_case("tau_c < 0.03 Nm"), skipped_case("c_v > 0 Nm·s/rad")];
        let report = junit("jointbench", &cases, &[]);
        assert!(report.contains("tests=\"3\" failures=\"0\" errors=\"1\" skipped=\"2\""), "{report}");
        assert!(report.contains("<error message=\"repeats = 0 &lt; 1\"/>"), "{report}");
        let skipped = "name=\"tau_c &lt; 0.03 Nm\" time=\"0.000\">\n      <skipped message=\"no run has completed";
        assert!(report.contains(skipped), "{report}");
    }

    #[test]
    fn an_exceeded_limit_is_a_failure_of_its_own() {
        let exceeded = Ok((LimitOutcome::Fail, "message".to_owned()));
        let cases = [case("friction run 1", CaseOutcome::Passed), limit_case("tau_c < 0.03 Nm", &exceeded)];
        let report = junit("joint-a", &cases, &["the joint is not warmed up".to_owned()]);
        assert!(report.contains("tests=\"2\" failures=\"1\" errors=\"0\" skipped=\"0\""), "{report}");
        assert!(report.contains("name=\"tau_c &lt; 0.03 Nm\""), "{report}");
        assert!(report.contains("<system-out>the joint is not warmed up</system-out>"), "{report}");
    }

    #[test]
    fn markup_in_a_reason_stays_text() {
        assert_eq!(escape("a < b & \"c\""), "a &lt; b &amp; &quot;c&quot;");
    }
}
