//! `jointbench units`: lists the units under test and their first-pass yield.

use super::arguments::Units;
use super::exit::Done;
use super::print::json_out;
use super::runs::{encoded, local};
use super::serve::runtime;
use super::transfer::{Target, open};
use crate::lab::LOCAL;
use crate::view::{FirstPassYield, Identified, UnitList, UnitReference, UnitSummary, spoken, word};
use jiff::tz::TimeZone;

pub fn units(arguments: &Units) -> Done {
    let runtime = runtime()?;
    let marked = [(&arguments.reference, true), (&arguments.no_reference, false)];
    if let Some((serial, reference)) = marked.into_iter().find_map(|(serial, is)| Some((serial.as_ref()?, is))) {
        return mark(&runtime, arguments, serial, reference);
    }
    let search = arguments.search.join(" ");
    let list: UnitList = match open(&runtime, &arguments.store, false)? {
        Target::Folder(lab) => runtime.block_on(lab.units(&search))?,
        Target::Daemon(client) => client.get(&format!("/units?search={}", encoded(&search)))?,
    };
    if arguments.json {
        return json_out(&list);
    }
    if list.units.is_empty() {
        println!(
            "{}",
            if search.is_empty() { "no run has a unit: start one with --unit SERIAL" } else { "no unit matches" }
        );
        return Ok(());
    }
    print_rows(&HEAD, list.units.iter().map(cells));
    let shown = list.units.len() as u64;
    if shown < list.total {
        println!("{shown} of {}: search terms such as batch:7 show others", list.total);
    }
    if !list.yields.is_empty() {
        println!("\nFirst-pass yield");
        print_rows(&YIELD_HEAD, list.yields.iter().map(yield_cells));
    }
    Ok(())
}

fn mark(runtime: &tokio::runtime::Runtime, arguments: &Units, serial: &str, reference: bool) -> Done {
    let unit: UnitSummary = match open(runtime, &arguments.store, false)? {
        Target::Folder(lab) => runtime.block_on(lab.set_unit_reference(serial, reference, LOCAL))?,
        Target::Daemon(client) => {
            client.put(&format!("/units/{}/reference", encoded(serial)), &UnitReference { reference })?
        }
    };
    if arguments.json {
        return json_out(&unit);
    }
    let is =
        if reference { "is a reference unit: yields and control charts exclude it" } else { "is no reference unit" };
    println!("{} {is}", unit.serial);
    Ok(())
}

const HEAD: [&str; 11] = [
    "unit",
    "reference",
    "part",
    "revision",
    "batch",
    "runs",
    "first verdict",
    "newest verdict",
    "limits",
    "newest run",
    "started (local)",
];
const YIELD_HEAD: [&str; 7] = ["by", "part", "revision", "batch", "procedure", "yield", "95 % interval"];

fn cells(unit: &UnitSummary) -> [String; 11] {
    let text = |text: &Option<String>| text.clone().unwrap_or_default();
    let verdict = |verdict: Option<Identified>| verdict.map(spoken).unwrap_or_default();
    [
        unit.serial.clone(),
        if unit.reference { "yes" } else { "" }.to_owned(),
        text(&unit.part),
        text(&unit.revision),
        text(&unit.batch),
        unit.runs.to_string(),
        verdict(unit.first_verdict),
        verdict(unit.newest_verdict),
        unit.newest_limits.map(word).unwrap_or_default(),
        unit.newest_run.to_string(),
        local(&unit.newest_at, &TimeZone::system()),
    ]
}

fn yield_cells(one: &FirstPassYield) -> [String; 7] {
    let text = |text: &Option<String>| text.clone().unwrap_or_default();
    let [low, high] = one.ci95.map(|end| 100.0 * end);
    let units = if one.units == 1 { "unit" } else { "units" };
    [
        word(one.group),
        text(&one.part),
        text(&one.revision),
        text(&one.batch),
        one.procedure.clone(),
        format!("{:.1} % of {} {units}", 100.0 * one.fraction, one.units),
        format!("{low:.1} to {high:.1} %"),
    ]
}

/// Columns as wide as their longest cell.
pub(super) fn print_rows<const N: usize>(head: &[&str; N], rows: impl Iterator<Item = [String; N]>) {
    let rows: Vec<[String; N]> = std::iter::once(head.map(str::to_owned)).chain(rows).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or_default();
    let widths: [usize; N] = std::array::from_fn(width);
    for row in &rows {
        let cells = row.iter().zip(widths).map(|(cell, width)| format!("{cell:width$}"));
        println!("{}", cells.collect::<Vec<_>>().join("  ").trim_end());
    }
}
