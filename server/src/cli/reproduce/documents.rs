//! `jointbench reproduce --documents`: how often the interval of a figure contains the value of the document, on a bench
//! with exactly these values.

use super::{SUBJECTS, bench_of, measure, titled, unwritable};
use crate::cli::arguments::Reproduce;
use crate::cli::exit::{Done, Exit};
use crate::report::with_interval;
use jointbench_devices::{Joint, MockSettings};
use jointbench_procedure::reproduce::{Comparison, Extent, ProcedureResult, Subject};
use std::fmt::Write;
use std::fs;

/// Fraction of the seeds in which the interval has to contain the value.
const LEAST_FRACTION: f64 = 0.9;
/// Load behind the gear as a fraction of 150 Nm: joint A ends at 70 Nm.
const GEAR_SHARE: f64 = 0.4;
/// Axes of the Puma in addition to that of [`SUBJECTS`].
const AXES: [(&str, usize); 5] =
    [("Puma, axis 1", 1), ("Puma, axis 3", 3), ("Puma, axis 4", 4), ("Puma, axis 5", 5), ("Puma, axis 6", 6)];
const COLUMNS: &str =
    "| bench | table | quantity | document | measured, mean | half width of the interval, mean | inside |";

const DEVIATIONS: &str = "## Sources

The figures are those of the two source documents. Table 3.1 is not in the text of document 000 that this project has: its Coulomb and mean viscous
friction agree with the parameters of the Puma 560 in Corke's Robotics Toolbox (1995); its breakaway and its viscous friction of each direction are
quoted from Corke 1996, table 2.12, and not compared with the print. The inertia of the wrist, the stiffness of each axis and a tool are assumed.

## Known deviations

* Usable bits: the thesis gives whole bits. Here they are the full range of the error, 9.4 bits with a shape error of about 250 points. The
  readings of this bench scatter less than those of the thesis, so that table and velocity term reach more than 14 bits.
* Breakaway friction of axis 5: table 3.1 gives 5.72 mNm, less than its Coulomb friction of 9.26 mNm. Friction that rises with speed lets the
  joint creep. The encoder shows five increases in a row only near Coulomb friction.
";

/// One figure of a document over all seeds.
struct Figure {
    bench: &'static str,
    /// From the first seed that has it.
    one: Comparison,
    values: Vec<f64>,
    half_widths: Vec<f64>,
    inside: u64,
}

impl Figure {
    /// `None`: the figure has no interval.
    fn holds(&self, seeds: u64) -> Option<bool> {
        (!self.half_widths.is_empty()).then_some(self.inside as f64 >= LEAST_FRACTION * seeds as f64)
    }

    fn row(&self, seeds: u64) -> String {
        let Comparison { table, found, document, .. } = &self.one;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let shown = |value: f64| with_interval(value, found.ci95, &found.unit).0;
        let (width, inside) = match self.holds(seeds) {
            None => (String::new(), String::new()),
            Some(holds) => {
                let share = format!("{} of {seeds}", self.inside);
                (
                    with_interval(mean(&self.half_widths), None, &found.unit).0,
                    if holds { share } else { format!("**{share}**") },
                )
            }
        };
        let document = document.map(shown).unwrap_or_default();
        format!(
            "| {} | {table} | {} | {document} | {} | {width} | {inside} |",
            self.bench,
            titled(found),
            shown(mean(&self.values))
        )
    }
}

pub fn reproduce(arguments: &Reproduce) -> Done {
    let mut figures: Vec<Figure> = Vec::new();
    // Check the path now: the measurements take minutes.
    write(&figures, arguments)?;
    for seed in arguments.seed..arguments.seed + arguments.seeds {
        let mut earlier: Vec<ProcedureResult> = Vec::new();
        for (bench, joint, mut subject) in subjects() {
            println!("{bench}, seed {seed}");
            subject.follow(&earlier);
            let settings = MockSettings { documents: true, ..bench_of(joint, subject, seed) };
            let results = measure(&settings, subject, Extent::Documented)?;
            results.iter().flat_map(|result| &result.comparisons).for_each(|one| count(&mut figures, bench, one));
            earlier.extend(results);
        }
    }
    println!("{}", page(&figures, arguments));
    write(&figures, arguments)?;
    let missed = figures.iter().filter(|figure| figure.holds(arguments.seeds) == Some(false));
    let missed: Vec<String> = missed.map(|figure| format!("{}: {}", figure.bench, figure.one.found.name)).collect();
    if missed.is_empty() { Ok(()) } else { Err(Exit::failed(format!("not reproduced: {}", missed.join(", ")))) }
}

fn subjects() -> impl Iterator<Item = (&'static str, Joint, Subject)> {
    let named = SUBJECTS.into_iter().map(|(bench, joint, subject)| match subject {
        Subject::GearAndBrakeB { .. } => (bench, joint, Subject::GearAndBrakeB { share: GEAR_SHARE }),
        _ => (bench, joint, subject),
    });
    named.chain(AXES.map(|(bench, axis)| (bench, Joint::Puma, Subject::Puma { axis })))
}

/// Adds the figure of one run, if the document has a value.
fn count(figures: &mut Vec<Figure>, bench: &'static str, one: &Comparison) {
    if one.document.is_none() {
        return;
    }
    let is_same = |figure: &Figure| {
        (figure.bench, figure.one.table, &figure.one.found.name) == (bench, one.table, &one.found.name)
    };
    let at = figures.iter().position(is_same).unwrap_or_else(|| {
        let (values, half_widths) = (Vec::new(), Vec::new());
        figures.push(Figure { bench, one: one.clone(), values, half_widths, inside: 0 });
        figures.len() - 1
    });
    let figure = &mut figures[at];
    figure.values.push(one.found.value);
    figure.half_widths.extend(one.found.ci95.map(|[low, high]| 0.5 * (high - low)));
    figure.inside += u64::from(one.contains_document() == Some(true));
}

fn write(figures: &[Figure], arguments: &Reproduce) -> Done {
    let Some(path) = &arguments.out else { return Ok(()) };
    fs::write(path, page(figures, arguments)).map_err(|fault| unwritable(path, &fault))
}

fn page(figures: &[Figure], arguments: &Reproduce) -> String {
    let Reproduce { seed, seeds, .. } = arguments;
    let mut page = format!(
        "# Bench of the documents\n\nWritten by `jointbench reproduce --documents --seed {seed} --seeds {seeds} --out …`, version {}. The simulated bench has exactly the values of the documents; the seed draws the noise of the instruments. *Inside* counts the seeds in which the 95 % interval contains the value of the document; at least {:.0} % have to. A figure without interval is shown, not judged.\n\n{COLUMNS}\n|---|---|---|---|---|---|---|\n",
        env!("CARGO_PKG_VERSION"),
        100.0 * LEAST_FRACTION,
    );
    for figure in figures {
        let _ = writeln!(page, "{}", figure.row(*seeds));
    }
    let judged: Vec<bool> = figures.iter().filter_map(|figure| figure.holds(*seeds)).collect();
    let held = judged.iter().filter(|holds| **holds).count();
    let _ = writeln!(page, "\n{held} of {} figures hold.\n\n{DEVIATIONS}", judged.len());
    page
}
