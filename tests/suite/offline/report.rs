//! The report of an imported run, as a page and as PDF.

use super::user_effects::{done, run_in, write_run};
use crate::browser;
use crate::program::{jointbench, stderr};
use std::path::Path;

/// Names the browser that prints.
const VARIABLE: &str = "JOINTBENCH_CHROMIUM";

/// A store with the run of a folder. The run is number 1.
fn imported(folder: &Path) {
    write_run(folder);
    done(folder, &["import", "run.csv", "--data", "data"]);
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").file_name());
    entries.map(|name| name.to_string_lossy().into_owned()).collect()
}

#[test]
fn a_report_has_a_block_of_signatures_and_the_run_on_each_page() {
    let folder = tempfile::tempdir().expect("a folder");
    imported(folder.path());
    done(folder.path(), &["report", "1", "--data", "data"]);
    let page = std::fs::read_to_string(folder.path().join("run-1.html")).expect("the report");
    for part in ["Provenance", "Unit under test", "Serial number", "Signature of the operator", "size: A4", "@top-left"]
    {
        assert!(page.contains(part), "{part}: {page}");
    }
}

#[test]
fn a_pdf_without_a_browser_is_refused_and_writes_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    imported(folder.path());
    let before = names(folder.path());
    let refused = |variable: &str, value: &str, why: &str| {
        let mut command = jointbench();
        command.env_remove(VARIABLE).env(variable, value).current_dir(folder.path());
        let output = command.args(["report", "1", "--data", "data", "--out", "r.pdf"]).output().expect("it starts");
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert!(stderr(&output).contains(why), "{}", stderr(&output));
        assert_eq!(names(folder.path()), before);
    };
    refused("PATH", "/nowhere", "apt-get install chromium");
    refused(VARIABLE, "/nowhere/chrome", "JOINTBENCH_CHROMIUM=/nowhere/chrome is not a file");
}

#[test]
fn a_report_is_printed_as_pdf() {
    if std::env::var_os(VARIABLE).is_none() && !browser::is_installed() {
        assert!(!browser::is_required(), "the browser is required: Chromium is not installed");
        eprintln!("SKIPPED: Chromium is not installed. The report was NOT printed as PDF.");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    // Letters that an address would have to escape.
    let inside = folder.path().join("to customer #1");
    std::fs::create_dir(&inside).expect("a folder");
    imported(&inside);
    let before = names(&inside).len();
    let output = run_in(&inside, &["report", "1", "--data", "data", "--out", "report.pdf"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let pdf = std::fs::read(inside.join("report.pdf")).expect("the PDF");
    assert!(pdf.starts_with(b"%PDF-") && pdf.len() > 10_000, "{} bytes", pdf.len());
    assert_eq!(names(&inside).len(), before + 1, "{:?}", names(&inside));
    let output = run_in(&inside, &["report", "1", "--data", "data", "--short", "--out", "short.pdf"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let sheets = |name: &str| {
        let pdf = std::fs::read(inside.join(name)).expect("the PDF");
        String::from_utf8_lossy(&pdf).matches("/Type /Page\n").count()
    };
    assert!(sheets("short.pdf") == 1 && sheets("report.pdf") > 1, "the first page is one sheet");
}
