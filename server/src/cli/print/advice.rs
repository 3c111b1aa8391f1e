//! Prints the next possible actions.

use crate::view::command;
use jointbench_instrument::Motion;
use jointbench_model::{Experiment, Fit, Verdict, formula, words};

/// Columns with data problems are no basis for advice.
pub fn is_any(undecided: Option<&String>, verdict: Verdict) -> bool {
    undecided.is_none() || verdict == Verdict::Adequate
}

/// Suggests an own formula over the axes of the summary, because the user may know an effect that the library lacks.
pub fn user_formula(columns: &[String], fit: &Fit) {
    let named: Vec<String> = columns.iter().filter_map(|column| formula::in_formula(fit.kind, column)).collect();
    if named.is_empty() {
        return;
    }
    println!();
    println!("next: define your own effect as a formula of {} with --own (see --help)", words::list(&named));
    let turns = fit.scope.as_ref().is_none_or(|scope| scope.motion != Motion::Linear);
    let angle = formula::signals(fit.kind)
        .iter()
        .find(|s| s.name.ends_with("position") && columns.iter().any(|column| *column == s.column));
    if let Some(angle) = angle.filter(|_| turns) {
        println!("  in a formula wrap({} - p) wraps this angle into one turn, -π to π", angle.name);
    }
}

/// Printed as a command, so that a user can copy it.
pub fn next_run(experiment: Option<&Experiment>) {
    let Some(experiment) = experiment else { return };
    println!();
    println!("recommended next run: {}", experiment.why);
    if let Some(duration_s) = experiment.expected_duration_s {
        println!("  at most {duration_s:.0} s of bench time:");
    }
    println!("  {}", command(&experiment.procedure, &experiment.parameters));
}
