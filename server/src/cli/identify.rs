//! `jointbench identify` and `jointbench report`: results of a stored run.

use super::arguments::{Identify, Report};
use super::exit::{Done, Exit};
use super::files::{writable, write};
use super::pdf::Browser;
use super::print::json_out;
use super::serve::runtime;
use super::transfer::{Target, open};
use crate::report::with_interval;
use crate::view::{Identification, Identified, Shown, command, word};
use std::path::PathBuf;

/// Digits of a SHA-256 in a line of text.
const SHOWN_DIGITS: usize = 12;

pub fn identify(arguments: &Identify) -> Done {
    let runtime = runtime()?;
    let run = arguments.run;
    let found = match open(&runtime, &arguments.store, false)? {
        Target::Folder(lab) => runtime.block_on(lab.identification(run))?,
        Target::Daemon(client) => client.get(&format!("/runs/{run}/identification"))?,
    };
    if arguments.json {
        json_out(&found)?;
    } else {
        print(&found);
    }
    ending(&found)
}

/// Exit code of a command that has printed a result.
pub(super) fn ending(found: &Identification) -> Done {
    match found.result.verdict {
        Identified::Identified | Identified::IdentifiedWithWarning => Ok(()),
        Identified::Inconclusive => Err(Exit::undecided("")),
        Identified::Failed => Err(Exit::failed("")),
    }
}

pub fn report(arguments: &Report) -> Done {
    let runtime = runtime()?;
    let run = arguments.run;
    let path = arguments.out.clone().unwrap_or_else(|| PathBuf::from(format!("run-{run}.html")));
    writable(&path)?;
    let is_pdf = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("pdf"));
    let browser = if is_pdf { Some(Browser::find()?) } else { None };
    let page = match open(&runtime, &arguments.store, false)? {
        Target::Folder(lab) => runtime.block_on(lab.report(run, None, arguments.short))?.into_bytes(),
        Target::Daemon(client) => client.get_bytes(&format!("/runs/{run}/report?short={}", arguments.short))?,
    };
    match browser {
        Some(browser) => browser.print(&page, &path)?,
        None => write(&path, &page)?,
    }
    println!("{}", path.display());
    Ok(())
}

pub(super) fn print(found: &Identification) {
    let result = &found.result;
    println!("{}", found.line());
    result.warnings.iter().for_each(|warning| println!("warning: {warning}"));
    if let Some(advice) = &result.advice {
        println!("advice: {advice}");
    }
    quantities(result);
    if let Some(check) = &found.limits {
        println!("\nLimits ({}):", &check.sha256[..SHOWN_DIGITS.min(check.sha256.len())]);
        check.limits.iter().for_each(|limit| println!("{}: {}", word(limit.outcome), limit.message));
    }
    if let Some(next) = &found.follow_up {
        println!("\nNext: {}\n  {}", next.why, command(&next.procedure, &next.parameters));
    }
}

fn quantities(result: &Shown) {
    if result.quantities.is_empty() {
        return;
    }
    println!();
    let rows: Vec<[String; 4]> = result
        .quantities
        .iter()
        .map(|quantity| {
            let (value, interval) = with_interval(quantity.value, quantity.ci95, &quantity.unit);
            let interval = interval.map(|ends| format!("[{ends}]")).unwrap_or_default();
            [quantity.name.clone(), value, interval, quantity.title.clone()]
        })
        .collect();
    let wide = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let (name, value, interval) = (wide(0), wide(1), wide(2));
    for row in &rows {
        println!("{:name$}  {:>value$}  {:interval$}  {}", row[0], row[1], row[2], row[3]);
    }
}
