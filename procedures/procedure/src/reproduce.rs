//! Reproduces the campaigns of the documents on a bench, with each table next to the document's.
//!
//! The caller provides the true values of the bench if they are known; they are only compared at the end.

mod campaign;

pub use campaign::Subject;

use crate::bench_facts::BenchFacts;
use crate::catalogue::{brake_model, procedure};
use crate::identification::{Identification, Quantity};
use crate::in_memory_run::{InMemoryRun, InMemoryRunFault, run_in_memory_with_facts};
use campaign::Figure;
use jointbench_instrument::Bench;
use serde_json::{Map, Value};
use statrs::distribution::{ContinuousCDF, Normal};

/// Requirement on a figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Requirement {
    /// Largest half width of its interval, in the unit of the quantity.
    Within(f64),
    /// The same, as a share of the value.
    WithinShare(f64),
    /// The value is at least this, in the unit of the quantity.
    AtLeast(f64),
    /// The value is at most this, in the unit of the quantity.
    AtMost(f64),
}

/// One figure of a table: the value of the document, of the run, and of the bench.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Number of the table or figure in the document.
    pub table: &'static str,
    /// The quantity of this run.
    pub found: Quantity,
    /// `None`: the document has no value.
    pub document: Option<f64>,
    /// `None`: unknown, or the bench has no such figure.
    pub given: Option<f64>,
    /// `None`: the figure is shown but not judged.
    pub demand: Option<Requirement>,
}

impl Comparison {
    /// Whether the interval contains the value of the document. `None` without one.
    pub fn contains_document(&self) -> Option<bool> {
        let ([low, high], document) = (self.found.ci95?, self.document?);
        Some((low..=high).contains(&document))
    }

    /// Whether the interval contains the true value of the bench. `None` without one.
    pub fn is_inside(&self) -> Option<bool> {
        let ([low, high], given) = (self.found.ci95?, self.given?);
        Some((low..=high).contains(&given))
    }

    /// The same if `of` intervals have to hold simultaneously in 95 of 100 campaigns ([`simultaneous_factor`]).
    pub fn is_inside_with(&self, of: u64) -> Option<bool> {
        let ([low, high], given, value) = (self.found.ci95?, self.given?, self.found.value);
        let wider = simultaneous_factor(of);
        Some((value + wider * (low - value)..=value + wider * (high - value)).contains(&given))
    }

    /// Whether the figure meets its requirement. `None` without one.
    pub fn meets_requirement(&self) -> Option<bool> {
        let value = self.found.value;
        let reaches = |widest: f64| self.found.ci95.map(|[low, high]| 0.5 * (high - low) <= widest);
        match self.demand? {
            Requirement::Within(widest) => reaches(widest),
            Requirement::WithinShare(share) => reaches(share * value.abs()),
            Requirement::AtLeast(least) => Some(value >= least),
            Requirement::AtMost(most) => Some(value <= most),
        }
    }
}

/// Factor by which `of` 95 % intervals have to be wider to hold simultaneously in 95 of 100 campaigns (Šidák 1967),
/// for normal deviates.
pub fn simultaneous_factor(of: u64) -> f64 {
    let normal = Normal::standard();
    let reach = |confidence: f64| normal.inverse_cdf(0.5 + 0.5 * confidence);
    reach(0.95_f64.powf(1.0 / of.max(1) as f64)) / reach(0.95)
}

/// One procedure of the campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct ProcedureResult {
    /// Id of the procedure.
    pub procedure: &'static str,
    /// Its title.
    pub title: &'static str,
    /// The parameters that differ from the defaults.
    pub parameters: Map<String, Value>,
    /// Result of its run.
    pub identification: Identification,
    /// Its figures next to those of the document.
    pub comparisons: Vec<Comparison>,
    /// On the bench's clock.
    pub duration_s: f64,
}

/// The procedures of a campaign that are run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// All of them.
    Complete,
    /// Those with a figure of a document.
    Documented,
}

/// Runs the campaign in its order and reports the result of each procedure when it is done. `given` contains the true values of the
/// bench, by the names of the quantities.
pub fn reproduce(
    bench: &mut Bench,
    subject: Subject,
    extent: Extent,
    given: &dyn Fn(&str) -> Option<f64>,
    done: &mut dyn FnMut(&ProcedureResult),
) -> Result<Vec<ProcedureResult>, InMemoryRunFault> {
    let mut results: Vec<ProcedureResult> = Vec::new();
    let mut facts = BenchFacts::of(bench);
    for (id, parameters, figures) in subject.campaign() {
        let is_documented = figures.iter().any(|(_, _, document, _)| document.is_some());
        let Some(procedure) = procedure(id).filter(|_| is_documented || extent == Extent::Complete) else { continue };
        let mut parameters = parameters.as_object().cloned().unwrap_or_default();
        if id == "compensation" {
            for result in &results {
                let next = crate::procedure(result.procedure).and_then(|of| of.follow_up(&result.identification));
                parameters
                    .extend(next.filter(|next| next.procedure == id).map(|next| next.parameters).unwrap_or_default());
            }
        }
        let InMemoryRun { table, identification, duration_s } =
            run_in_memory_with_facts(bench, &facts, procedure, &parameters)?;
        if id == "brake_hysteresis" {
            facts.brake_model = brake_model(&table);
        }
        let Some(identification) = identification else { continue };
        let comparisons = compare(&identification, &figures, given);
        let title = procedure.title();
        let result =
            ProcedureResult { procedure: procedure.id(), title, parameters, identification, comparisons, duration_s };
        done(&result);
        results.push(result);
    }
    Ok(results)
}

fn compare(found: &Identification, figures: &[Figure], given: &dyn Fn(&str) -> Option<f64>) -> Vec<Comparison> {
    let one = |(table, name, document, demand): &Figure| {
        let found = found.quantity(name)?.clone();
        Some(Comparison { table, found, document: *document, given: given(name), demand: *demand })
    };
    figures.iter().filter_map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::campaign::friction;
    use super::*;
    use crate::findings::quantity;
    use crate::identification::Verdict;

    fn found(names: &[(&str, f64)]) -> Identification {
        let made =
            |(name, value): &(&str, f64)| quantity([name, "", "", ""], *value, Some([0.99 * value, 1.01 * value]));
        let quantities = names.iter().map(made).collect();
        let summary = String::new();
        Identification { verdict: Verdict::Identified, summary, quantities, ..Identification::default() }
    }

    #[test]
    fn an_interval_is_held_against_what_the_bench_was_given() {
        let found = found(&[("tau_c", 0.0300), ("c_v", 1.6e-4)]);
        let given = |name: &str| (name == "tau_c").then_some(0.0302);
        let comparisons = compare(&found, &friction([0.030, 1.512e-4, 0.039, 0.06, 0.8]), &given);
        assert_eq!(comparisons.iter().map(|c| c.document).collect::<Vec<_>>(), [Some(0.030), Some(1.512e-4)]);
        assert_eq!(
            comparisons.iter().map(Comparison::contains_document).collect::<Vec<_>>(),
            [Some(true), Some(false)]
        );
        assert_eq!((comparisons[0].is_inside(), comparisons[0].meets_requirement()), (Some(true), Some(true)));
        assert_eq!((comparisons[1].is_inside(), comparisons[1].meets_requirement()), (None, Some(true)));
    }

    #[test]
    fn intervals_that_hold_together_are_wider() {
        let found = found(&[("tau_c", 0.0300)]);
        let off = |given: f64| {
            let of_table = [("4.5", "tau_c", None, None)];
            compare(&found, &of_table, &|_| Some(given)).remove(0)
        };
        // ±1 % alone; 1 − 0.95^(1/31) is two-sided 3.146 standard deviations, and 3.146 / 1.960 = 1.605.
        let (near, far) = (off(0.0300 * 1.016), off(0.0300 * 1.0161));
        assert_eq!(
            (near.is_inside(), near.is_inside_with(1), near.is_inside_with(31)),
            (Some(false), Some(false), Some(true))
        );
        assert_eq!(far.is_inside_with(31), Some(false));
        assert_eq!(off(0.0300 * 0.991).is_inside_with(1), Some(true));
    }
}
