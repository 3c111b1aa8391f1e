//! `jointbench reproduce --documents`: how often the interval of a figure contains the value of the document, on a bench
//! with exactly these values, and the state of every row of the documents.

use super::coverage::{JudgedRow, Measured, State, tables};
use super::figure::{self, Figure, LEAST_FRACTION, count};
use super::performed::{Performed, perform};
use super::row::{Row, rows};
use super::{benches, measure, unwritable};
use crate::cli::arguments::Reproduce;
use crate::cli::exit::{Done, Exit};
use jointbench_procedure::reproduce::{Extent, ProcedureResult};
use std::fmt::Write;
use std::fs;

const DEVIATIONS: &str = "## Sources

The figures are those of the two source documents. Table 3.1 is not in the text of Corke 1994 that this project has: its Coulomb and mean viscous
friction agree with the parameters of the Puma 560 in Corke's Robotics Toolbox of 1995; its breakaway and its viscous friction of each direction are
quoted from Corke 1996, table 2.12, and not compared with the print. The inertia of the wrist, the stiffness of each axis and a tool are assumed.

## Known deviations

* Usable bits: the thesis gives whole bits. Here they are the full range of the error, 9.4 bits with a shape error of about 250 points. The
  readings of this bench scatter less than those of the thesis, so that table and velocity term reach more than 14 bits.
* Delay of the encoder: 64.34 µs is the mean of the quotients of table 4.2. Its differences also contain 2 points that do not depend on the speed.
  The slope alone is 63.7 µs. The table gives no scatter, so that the intervals of tables 4.2 and 4.3 come from its deviation from straight lines.
* Breakaway friction of axis 5: table 3.1 gives 5.72 mNm, less than its Coulomb friction of 9.26 mNm. Friction that rises with speed lets the
  joint creep. The encoder shows five increases in a row only near Coulomb friction.
* Compensation is inconclusive on this bench: the motion lags behind the reference by 43 ms, so that the feed-forward of five methods exceeds the
  torque of the drive for a moment. The tracking errors have their intervals.
";

pub fn reproduce(arguments: &Reproduce) -> Done {
    let rows = rows().map_err(Exit::failed)?;
    let Reproduce { seed: first, seeds, .. } = *arguments;
    let mut measured = Measured { seeds, ..Measured::default() };
    // Check the path now: the measurements take minutes.
    write(arguments, &page(arguments, &measured, &rows))?;
    for seed in first..first + seeds {
        let mut earlier: Vec<ProcedureResult> = Vec::new();
        for (bench, joint, mut subject) in benches::subjects() {
            println!("{bench}, seed {seed}");
            subject.follow(&earlier);
            let results = measure(&benches::exact(joint, subject, seed), subject, Extent::Documented)?;
            results.iter().flat_map(|result| &result.comparisons).for_each(|one| {
                count(&mut measured.figures, bench, one);
            });
            if seed == first {
                measured.performed.extend(results.iter().map(|result| Performed::of_campaign(bench, result)));
            }
            earlier.extend(results);
        }
    }
    let evidence = rows.iter().flat_map(|row| &row.evidence);
    measured.answered = perform(&mut measured.performed, evidence, first)?;
    let page = page(arguments, &measured, &rows);
    println!("{page}");
    write(arguments, &page)?;
    verdict(&measured, &rows)
}

/// Every figure has to hold, and every row to work.
fn verdict(measured: &Measured, rows: &[Row]) -> Done {
    let missed = measured.figures.iter().filter(|figure| figure.holds(measured.seeds) == Some(false));
    let missed: Vec<String> = missed.map(|figure| format!("{}: {}", figure.bench, figure.one.found.name)).collect();
    let open = rows.iter().filter(|row| measured.judge(row).state != State::Works).count();
    let mut faults = Vec::new();
    if !missed.is_empty() {
        faults.push(format!("not reproduced: {}", missed.join(", ")));
    }
    if open > 0 {
        faults.push(format!("{open} of {} rows work partly or are missing", rows.len()));
    }
    if faults.is_empty() { Ok(()) } else { Err(Exit::failed(faults.join("; "))) }
}

fn write(arguments: &Reproduce, page: &str) -> Done {
    let Some(path) = &arguments.out else { return Ok(()) };
    fs::write(path, page).map_err(|fault| unwritable(path, &fault))
}

/// Introduction of the page.
fn preamble(seed: u64, seeds: u64) -> String {
    format!(
        "# Bench of the documents\n\nWritten by `jointbench reproduce --documents --seed {seed} --seeds {seeds} --out …`, version {}. The simulated bench has exactly the values of the documents; the seed draws the noise of the instruments. *Inside* counts the seeds in which the 95 % interval contains the value of the document; at least {:.0} % have to. A figure without interval is shown, not judged.\n\n{}\n|---|---|---|---|---|---|---|\n",
        env!("CARGO_PKG_VERSION"),
        100.0 * LEAST_FRACTION,
        figure::COLUMNS,
    )
}

fn page(arguments: &Reproduce, measured: &Measured, rows: &[Row]) -> String {
    let seeds = arguments.seeds;
    let mut page = preamble(arguments.seed, seeds);
    for figure in &measured.figures {
        let _ = writeln!(page, "{}", figure.row(seeds));
    }
    let judged: Vec<bool> = measured.figures.iter().filter_map(|figure: &Figure| figure.holds(seeds)).collect();
    let held = judged.iter().filter(|holds| **holds).count();
    let rows: Vec<JudgedRow> = rows.iter().map(|row| measured.judge(row)).collect();
    let _ = writeln!(page, "\n{held} of {} figures hold.\n\n{}\n{DEVIATIONS}", judged.len(), tables(&rows));
    page
}

#[cfg(test)]
mod tests {
    use super::super::coverage::{COLUMNS, fixed_cells};
    use super::*;

    /// Compares the parts of the page that no measurement changes: the figures take minutes.
    #[test]
    fn the_kept_page_is_one_of_this_program() {
        let page = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/documents.md")).unwrap();
        let renew = "renew it with `jointbench reproduce --documents --seeds 20 --out docs/documents.md`";
        assert!(page.starts_with(&preamble(1, 20)), "the page begins otherwise: {renew}");
        assert!(page.contains(DEVIATIONS) && page.contains(COLUMNS), "{renew}");
        for (bench, ..) in benches::subjects() {
            assert!(page.contains(&format!("\n| {bench} | ")), "no figure of {bench}: {renew}");
        }
        let rows = rows().unwrap();
        let (_, kept) = page.split_once("## Rows of the documents\n").expect(renew);
        let mut lines = kept.lines();
        for row in &rows {
            let [first, shown_by] = fixed_cells(row);
            let line = lines.find(|line| line.starts_with(&first));
            let is_kept = line.is_some_and(|line| line.contains(&shown_by) && line.contains(row.missing));
            assert!(is_kept, "{}: {renew}", row.item);
        }
        let sections: Vec<&str> = kept.lines().filter_map(|line| line.strip_prefix("### ")).collect();
        let mut expected: Vec<&str> = rows.iter().map(|row| row.section).collect();
        expected.dedup();
        assert_eq!(sections, expected, "{renew}");
    }
}
