//! Errors of fits and diagnoses. An effect that the data cannot show is part of the verdict, not an error.

use jointbench_instrument::Kind;
use jointbench_instrument::spelling::instead;

/// Every message states what to do next.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ModelError {
    #[error("effect {id} is not known for {kind} runs; {}", instead(id, &.known.iter().map(String::as_str).collect::<Vec<_>>()))]
    UnknownEffect { id: String, kind: Kind, known: Vec<String> },
    #[error("effect {0} is named twice; name each effect once")]
    TwiceNamed(String),
    #[error(
        "the model has no effects: name some (--model inertia,coulomb,viscous for friction), or give them as \"baseline\" in the meta file"
    )]
    EmptyModel,
    #[error(
        "effects of the kind {model} cannot explain this run, which is of the kind {run}: choose effects of that kind"
    )]
    WrongKind { run: Kind, model: Kind },
    #[error("{needed} is missing in the meta file; add it")]
    MissingConstant { needed: &'static str },
    #[error("too few samples: {usable} usable {what}, at least {needed} are needed; record a longer run")]
    TooFewSamples { usable: usize, needed: usize, what: &'static str },
    #[error("effect {effect} is not visible in this data: {why}; leave it out of the model, or measure what it needs")]
    NotVisible { effect: String, why: String },
    #[error(
        "{first} and {second} are confounded: their columns are proportional in this data; remove one, or record a run in which they differ"
    )]
    Collinear { first: String, second: String },
    #[error("{column} never changes: nothing can be identified; record a run in which it does")]
    Constant { column: String },
    #[error("{column} reaches {value:e}, with which nothing can be computed; check its unit and how it was written")]
    TooLarge { column: String, value: f64 },
    /// An invalid user effect, with the position of the error.
    #[error(transparent)]
    Formula(#[from] Box<crate::FormulaFault>),
    #[error(
        "effect {effect} is not finite at {points} points of this data, {first}; \
         write a formula that is defined there, or give its parameters bounds that keep it so"
    )]
    /// `first`: the first position, or a statement that the formula fails for any signals.
    NotFinite { effect: String, points: usize, first: String },
    #[error("signal {signal}: {why}")]
    BadSignal { signal: String, why: String },
    #[error("the fit does not say where it holds: it was made by another version; fit the run again")]
    NoScope,
    #[error("a model of kind {kind} cannot be written as {what}: {why}")]
    NoExport { kind: Kind, what: &'static str, why: &'static str },
    #[error("this is no exported model: {0}; export one with `jointbench model export`")]
    BadFile(String),
    #[error("a {first} model and a {second} model have nothing to compare; choose two of one kind")]
    OtherKind { first: Kind, second: Kind },
    #[error("the option {option} is out of range: {why}")]
    BadOption { option: &'static str, why: String },
    #[error("the stored fit has no form {form} of effect {effect}: it was made by another version; fit the run again")]
    UnknownForm { effect: String, form: String },
}
