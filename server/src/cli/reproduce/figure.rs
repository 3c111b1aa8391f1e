//! A figure of a document over all seeds.

use super::titled;
use crate::report::with_interval;
use jointbench_model::stats::summary::mean;
use jointbench_procedure::reproduce::Comparison;

/// Fraction of the seeds in which the interval has to contain the value.
pub const LEAST_FRACTION: f64 = 0.9;
pub const COLUMNS: &str =
    "| bench | table | quantity | document | measured, mean | half width of the interval, mean | inside |";

/// One figure of a document over all seeds.
pub struct Figure {
    pub bench: &'static str,
    /// From the first seed that has it.
    pub one: Comparison,
    pub values: Vec<f64>,
    half_widths: Vec<f64>,
    pub inside: u64,
}

impl Figure {
    /// `None`: the figure has no interval.
    pub fn holds(&self, seeds: u64) -> Option<bool> {
        (!self.half_widths.is_empty()).then_some(self.inside as f64 >= LEAST_FRACTION * seeds as f64)
    }

    /// The value of the document.
    pub fn document(&self) -> String {
        self.one.document.map(|value| self.shown(value)).unwrap_or_default()
    }

    /// Mean of the measured values, and mean half width of their intervals.
    pub fn measured(&self) -> (String, Option<String>) {
        let width = self.holds(1).map(|_| with_interval(mean(&self.half_widths), None, &self.one.found.unit).0);
        (self.shown(mean(&self.values)), width)
    }

    pub fn shown(&self, value: f64) -> String {
        with_interval(value, self.one.found.ci95, &self.one.found.unit).0
    }

    pub fn row(&self, seeds: u64) -> String {
        let (measured, width) = self.measured();
        let inside = self.holds(seeds).map_or(String::new(), |holds| {
            let share = format!("{} of {seeds}", self.inside);
            if holds { share } else { format!("**{share}**") }
        });
        let (table, title, width) = (self.one.table, titled(&self.one.found), width.unwrap_or_default());
        format!("| {} | {table} | {title} | {} | {measured} | {width} | {inside} |", self.bench, self.document())
    }
}

/// Adds the figure of one run, if the document has a value.
pub fn count(figures: &mut Vec<Figure>, bench: &'static str, one: &Comparison) {
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
