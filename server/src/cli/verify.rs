//! `jointbench verify`: checks that all stored data is readable.

use super::arguments::Verify;
use super::exit::{Done, Exit};
use super::print::json_out;
use super::serve::runtime;
use crate::lab::LabError;
use crate::store::{VerifyReport, verify as check};

pub fn verify(arguments: &Verify) -> Done {
    let report = runtime()?.block_on(check(&arguments.data)).map_err(LabError::from)?;
    if arguments.json {
        json_out(&report)?;
    } else {
        print(&report);
    }
    let damaged = report.damaged.len();
    match damaged {
        0 => Ok(()),
        _ => {
            Err(Exit::failed(format!("the store in {} is damaged: restore it from a backup", arguments.data.display())))
        }
    }
}

fn print(report: &VerifyReport) {
    for finding in &report.damaged {
        let run = finding.run.map(|run| format!("run {run}, ")).unwrap_or_default();
        println!("damaged: {run}{}: {}", finding.table, finding.what);
    }
    for part in &report.readable {
        let run = part.run.map(|run| format!("run {run}, ")).unwrap_or_default();
        println!("readable: {run}{}: {} of {} records", part.table, part.readable, part.of);
    }
    for loss in report.lost.iter().filter(|loss| loss.noticed_at.is_some()) {
        println!("detected at {}: {loss}", loss.noticed_at.as_deref().unwrap_or_default());
    }
    if report.without_checksum > 0 {
        println!(
            "{} records of an older release have no checksum: the daemon adds them within one day",
            report.without_checksum
        );
    }
    let VerifyReport { runs, rows, records, .. } = report;
    println!("runs: {runs}; rows of samples: {rows}; records read: {records}; damaged: {}", report.damaged.len());
}
