//! The first line of a reply: an answer follows, or the refusal.

use crate::error::LabError;
use jointbench_model::FormulaFault;
use jointbench_model::formula::FurtherFault;
use serde::{Deserialize, Serialize};

#[derive(Debug, Serialize, Deserialize)]
pub enum Head {
    /// The answer follows.
    Answer,
    Refused(Box<Refusal>),
}

/// A [`LabError`] in serialized form.
#[derive(Debug, Serialize, Deserialize)]
pub struct Refusal {
    kind: Kind,
    text: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    line: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    column: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    formula: Option<Formula>,
}

/// An error in a formula that depends on the columns of a run.
#[derive(Debug, Serialize, Deserialize)]
struct Formula {
    effect: String,
    field: String,
    text: String,
    position: usize,
    length: usize,
    message: String,
    /// Position, length and message of further errors.
    also: Vec<(usize, usize, String)>,
}

/// The parts of a definition that can contain an error.
const FIELDS: [&str; 4] = ["formula", "parameters", "id", "inline"];

#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
enum Kind {
    NotFound,
    Invalid,
    Formula,
    File,
    Conflict,
    Over,
    Gone,
    Bench,
    Setup,
    Busy,
    TooLarge,
    Internal,
}

impl From<LabError> for Refusal {
    fn from(error: LabError) -> Self {
        let text = error.to_string();
        let kind = match error {
            LabError::NotFound(_) => Kind::NotFound,
            LabError::Invalid(_) => Kind::Invalid,
            LabError::Formula(fault) => {
                let formula = Some(Formula::from(*fault));
                return Self { kind: Kind::Formula, text, line: None, column: None, formula };
            }
            LabError::File { line, column, .. } => {
                return Self { kind: Kind::File, text, line, column, formula: None };
            }
            LabError::Conflict(_) => Kind::Conflict,
            LabError::Over(_) => Kind::Over,
            LabError::Gone(_) => Kind::Gone,
            LabError::Bench(_) => Kind::Bench,
            LabError::Setup(_) => Kind::Setup,
            LabError::Busy(_) => Kind::Busy,
            LabError::TooLarge(_) => Kind::TooLarge,
            LabError::Internal(_) => Kind::Internal,
        };
        Self { kind, text, line: None, column: None, formula: None }
    }
}

impl From<Refusal> for LabError {
    fn from(refusal: Refusal) -> Self {
        let Refusal { kind, text, line, column, formula } = refusal;
        match kind {
            Kind::NotFound => LabError::NotFound(text),
            Kind::Invalid => LabError::Invalid(text),
            Kind::Formula => match formula {
                Some(formula) => LabError::Formula(Box::new(formula.into())),
                None => LabError::Invalid(text),
            },
            Kind::File => LabError::File { detail: text, line, column },
            Kind::Conflict => LabError::Conflict(text),
            Kind::Over => LabError::Over(text),
            Kind::Gone => LabError::Gone(text),
            Kind::Bench => LabError::Bench(text),
            Kind::Setup => LabError::Setup(text),
            Kind::Busy => LabError::Busy(text),
            Kind::TooLarge => LabError::TooLarge(text),
            Kind::Internal => LabError::Internal(text),
        }
    }
}

impl From<FormulaFault> for Formula {
    fn from(fault: FormulaFault) -> Self {
        let FormulaFault { effect, field, text, position, length, message, also } = fault;
        let also = also.into_iter().map(|also| (also.position, also.length, also.message)).collect();
        Self { effect, field: field.to_owned(), text, position, length, message, also }
    }
}

impl From<Formula> for FormulaFault {
    fn from(formula: Formula) -> Self {
        let Formula { effect, field, text, position, length, message, also } = formula;
        let field = FIELDS.into_iter().find(|known| *known == field).unwrap_or(FIELDS[0]);
        let also =
            also.into_iter().map(|(position, length, message)| FurtherFault { position, length, message }).collect();
        Self { effect, field, text, position, length, message, also }
    }
}

impl Head {
    /// One line with its line end.
    pub fn line(&self) -> Vec<u8> {
        let mut line = serde_json::to_vec(self).expect("a head is plain JSON");
        line.push(b'\n');
        line
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_comes_back_as_it_was() {
        let errors = [
            LabError::NotFound("no".into()),
            LabError::File { detail: "bad\nrow".into(), line: Some(3), column: Some("time_s".into()) },
            LabError::TooLarge("much".into()),
            LabError::Busy("wait".into()),
            LabError::Formula(Box::new(FormulaFault {
                effect: "rub".into(),
                field: "parameters",
                text: "oil".into(),
                position: 1,
                length: 2,
                message: "no column oil".into(),
                also: Box::new([FurtherFault { position: 3, length: 4, message: "nor this".into() }]),
            })),
        ];
        for error in errors {
            let expected = format!("{error:?}");
            let line = Head::Refused(Box::new(error.into())).line();
            assert_eq!(line.iter().filter(|byte| **byte == b'\n').count(), 1);
            let Head::Refused(refusal) = serde_json::from_slice(&line).unwrap() else { panic!("{expected}") };
            assert_eq!(format!("{:?}", LabError::from(*refusal)), expected);
        }
    }
}
