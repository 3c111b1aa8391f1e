//! Errors of fits and diagnoses. An effect that the data cannot show is part of the verdict, not an error.

use jointbench_instrument::Kind;
use jointbench_instrument::spelling::instead;

/// Every message states what to do next.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// A model names an effect that is neither in the library of its kind nor a user effect.
    #[error("effect {id} is not known for {kind} runs; {}", instead(id, &.known.iter().map(String::as_str).collect::<Vec<_>>()))]
    UnknownEffect {
        /// The unknown id.
        id: String,
        /// Kind of the model.
        kind: Kind,
        /// Ids of all effects of the kind, user effects last.
        known: Vec<String>,
    },
    /// A model contains the effect with this id twice, or two user effects have it.
    #[error("effect {0} is named twice; name each effect once")]
    TwiceNamed(String),
    /// A model without effects, as from a meta file without `baseline`.
    #[error(
        "the model has no effects: name some (--model inertia,coulomb,viscous for friction), or give them as \"baseline\" in the meta file"
    )]
    EmptyModel,
    /// A model or fit meets a run of another kind.
    #[error(
        "effects of the kind {model} cannot explain this run, which is of the kind {run}: choose effects of that kind"
    )]
    WrongKind {
        /// Kind of the run.
        run: Kind,
        /// Kind of the model.
        model: Kind,
    },
    /// The meta file lacks a constant that converts columns to model quantities.
    #[error("{needed} is missing in the meta file; add it")]
    MissingConstant {
        /// Name in the meta file.
        needed: &'static str,
    },
    /// The run is too short, or has too few chunks at steady state, to be fitted.
    #[error("too few samples: {usable} usable {what}, at least {needed} are needed; record a longer run")]
    TooFewSamples {
        /// Number that the run has.
        usable: usize,
        /// Smallest number for a fit.
        needed: usize,
        /// What is counted: samples, chunks, filtered rows or operating points.
        what: &'static str,
    },
    /// The column of an effect is zero or overflows in this data, or the evaluated run lacks a column of the fit.
    #[error("effect {effect} is not visible in this data: {why}; leave it out of the model, or measure what it needs")]
    NotVisible {
        /// Id of the effect.
        effect: String,
        /// Reason in words.
        why: String,
    },
    /// The columns of the model are linearly dependent at the points of the run (condition number above 1e9).
    #[error(
        "{first} and {second} are confounded: their columns are proportional in this data; remove one, or record a run in which they differ"
    )]
    Collinear {
        /// One effect of the dependence.
        first: String,
        /// The other effect; the same as `first` if two columns of one effect are dependent.
        second: String,
    },
    /// The response or the excitation of the run is constant, as of a channel that was not connected.
    #[error("{column} never changes: nothing can be identified; record a run in which it does")]
    Constant {
        /// The constant column, or the response as a formula of columns.
        column: String,
    },
    /// A value of the run above 1e100, whose sums of squares would overflow.
    #[error("{column} reaches {value:e}, with which nothing can be computed; check its unit and how it was written")]
    TooLarge {
        /// Column of the value.
        column: String,
        /// The first such value, in the unit of the column.
        value: f64,
    },
    /// An invalid user effect, with the position of the error.
    #[error(transparent)]
    Formula(#[from] Box<crate::FormulaFault>),
    /// A user effect is not finite at some points of the run for every tested set of nonlinear parameters.
    #[error(
        "effect {effect} is not finite at {points} points of this data, {first}; \
         write a formula that is defined there, or give its parameters bounds that keep it so"
    )]
    NotFinite {
        /// Id of the user effect.
        effect: String,
        /// Number of points for the best set of parameters.
        points: usize,
        /// The first such point with its signals, or a statement that the formula fails for any signals.
        first: String,
    },
    /// `export::predict` was given an unknown signal, or signals of different length.
    #[error("signal {signal}: {why}")]
    BadSignal {
        /// Formula name of the signal.
        signal: String,
        /// Reason in words.
        why: String,
    },
    /// An export needs the range of validity, which a fit of an earlier version does not contain.
    #[error("the fit does not say where it holds: it was made by another version; fit the run again")]
    NoScope,
    /// The export format cannot represent a model of this kind.
    #[error("a model of kind {kind} cannot be written as {what}: {why}")]
    NoExport {
        /// Kind of the model.
        kind: Kind,
        /// The format in words.
        what: &'static str,
        /// Reason in words.
        why: &'static str,
    },
    /// A model file is no JSON, has another format or version, or is inconsistent. The text is the reason.
    #[error("this is no exported model: {0}; export one with `jointbench model export`")]
    BadFile(String),
    /// `compare` was given fits of two kinds.
    #[error("a {first} model and a {second} model have nothing to compare; choose two of one kind")]
    OtherKind {
        /// Kind of the first fit.
        first: Kind,
        /// Kind of the second fit.
        second: Kind,
    },
    /// An option is outside its range, or too large for the sample rate of the run.
    #[error("the option {option} is out of range: {why}")]
    BadOption {
        /// Name of the field of `Options`.
        option: &'static str,
        /// The expected range in words.
        why: String,
    },
    /// A fixed value, a bound or a start value that no fit can follow.
    #[error("parameter {effect}.{name}: {why}")]
    BadSetting {
        /// Id of the effect.
        effect: String,
        /// Name of the parameter.
        name: String,
        /// Reason in words, with the remedy.
        why: String,
    },
    /// The tests of a diagnosis fit every parameter freely.
    #[error(
        "a model with fixed or bounded parameters is not diagnosed, because the tests fit every parameter freely; diagnose \
         the model without these settings"
    )]
    NotDiagnosed,
    /// A stored fit contains a form that this version of the effect does not have.
    #[error("the stored fit has no form {form} of effect {effect}: it was made by another version; fit the run again")]
    UnknownForm {
        /// Id of the effect.
        effect: String,
        /// Name of the form in the fit.
        form: String,
    },
}
