//! What shows a row of the documents: a figure, a run, a driver, an effect or a test.

use jointbench_instrument::Kind;
use serde_json::{Map, Value};

/// What shows a row.
#[derive(Debug, Clone, PartialEq)]
pub enum Evidence {
    /// Figures of the documents that are measured in all seeds.
    Figures { bench: String, names: Vec<String> },
    /// A run whose result is identified and contains these quantities and figures.
    Run { run: PlannedRun, results: Vec<String> },
    /// An instrument of the bench answers to this driver.
    Driver { bench: String, role: String, driver: String },
    /// An effect of the library.
    Effect { kind: Kind, id: String },
    /// A test with this name.
    Test { file: String, name: String },
}

/// A run of a procedure on a bench of the documents.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedRun {
    pub bench: String,
    pub procedure: String,
    /// Those that differ from the defaults, or from those of the campaign.
    pub parameters: Map<String, Value>,
}

impl Evidence {
    /// Reads `figure BENCH: NAMES`, `run BENCH: PROCEDURE {PARAMETERS} > RESULTS`, `driver BENCH: ROLE DRIVER`,
    /// `effect KIND: ID` or `test FILE: NAME`.
    pub fn parse(text: &str) -> Option<Self> {
        let (word, rest) = text.split_once(' ')?;
        let (place, given) = rest.split_once(": ")?;
        let (place, given) = (place.to_owned(), given.trim());
        Some(match word {
            "figure" => Evidence::Figures { bench: place, names: list(given) },
            "run" => {
                let (run, results) = given.split_once(" > ").unwrap_or((given, ""));
                let (procedure, parameters) = run.split_once(' ').unwrap_or((run, "{}"));
                let parameters = serde_json::from_str(parameters).ok()?;
                let run = PlannedRun { bench: place, procedure: procedure.to_owned(), parameters };
                Evidence::Run { run, results: list(results) }
            }
            "driver" => {
                let (role, driver) = given.split_once(' ')?;
                Evidence::Driver { bench: place, role: role.to_owned(), driver: driver.to_owned() }
            }
            "effect" => {
                let kind = Kind::ALL.into_iter().find(|kind| kind.name() == place)?;
                Evidence::Effect { kind, id: given.to_owned() }
            }
            "test" => Evidence::Test { file: place, name: given.to_owned() },
            _ => return None,
        })
    }

    pub fn is_figure(&self) -> bool {
        matches!(self, Evidence::Figures { .. })
    }
}

fn list(text: &str) -> Vec<String> {
    text.split(", ").filter(|name| !name.is_empty()).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_form_is_read() {
        let run = Evidence::parse(r#"run Puma, axis 1: warm_up {"speed": 90} > torque, drift"#).unwrap();
        let Evidence::Run { run, results } = run else { panic!("{run:?}") };
        assert_eq!((run.bench.as_str(), run.procedure.as_str()), ("Puma, axis 1", "warm_up"));
        assert_eq!((run.parameters["speed"].as_f64(), results.len()), (Some(90.0), 2));
        assert_eq!(
            Evidence::parse("effect friction: coulomb"),
            Some(Evidence::Effect { kind: Kind::Friction, id: "coulomb".into() })
        );
        for wrong in ["figure", "run Puma: warm_up {", "effect heat: coulomb", "driver Puma: joint", "word a: b"] {
            assert_eq!(Evidence::parse(wrong), None, "{wrong}");
        }
    }
}
