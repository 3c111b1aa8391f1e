//! Regressors of an effect as text for a controller.
//!
//! The formulas use the language of user effects, with the nonlinear parameters of the form as their parameters, so
//! that both share one printer. A test compares every formula with its effect.

/// Regressors of a form, or why a controller cannot compute them.
pub type Symbolic = Result<Vec<Column>, &'static str>;

/// Reason of an effect without formulas.
pub const UNKNOWN: &str = "its form is not written out for a controller";

/// The form of a fitted effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FittedForm<'t> {
    pub name: &'t str,
    /// Number of coefficients.
    pub linear: usize,
    /// Number of nonlinear parameters.
    pub shape: usize,
}

/// A regressor, multiplied by its coefficient.
#[derive(Debug, Clone, PartialEq)]
pub enum Column {
    Formula(String),
    /// A formula in which `z` is a state that follows a signal. All columns of an effect follow the same signal.
    Memory {
        rule: Rule,
        signal: &'static str,
        /// Number of the nonlinear parameter that is its reach, or its time constant.
        reach: usize,
        /// Limit of a Dahl state; other states do not use it.
        end: &'static str,
        formula: &'static str,
    },
    /// Stop operators weighted by hat functions over their reach (Prandtl–Ishlinskii).
    Band {
        stops: usize,
        bands: usize,
        band: usize,
    },
}

/// How a state follows its signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    Dahl,
    Stop,
    /// The mean of stop operators with reaches evenly spaced up to the largest.
    MaxwellSlip,
    Lag,
}

impl Rule {
    /// The rule of a hysteresis form, of its first component if it has several.
    pub fn of(form: &str) -> Self {
        match form {
            "stop" | "stops" => Self::Stop,
            "maxwell_slip" | "maxwell_slip_and_stops" => Self::MaxwellSlip,
            _ => Self::Dahl,
        }
    }
}

/// One regressor without a state.
pub fn formula(text: impl Into<String>) -> Symbolic {
    Ok(vec![Column::Formula(text.into())])
}

/// One regressor with a state.
pub fn memory(rule: Rule, signal: &'static str, formula: &'static str) -> Symbolic {
    Ok(vec![component(0, rule, signal, formula)])
}

/// A regressor whose state has the nonlinear parameter with the number `reach`.
pub fn component(reach: usize, rule: Rule, signal: &'static str, formula: &'static str) -> Column {
    Column::Memory { rule, signal, reach, end: "1", formula }
}

/// Cosine and sine of each order of an angle, with a factor.
pub fn waves(angle: &str, times: &str, orders: &[impl AsRef<str>]) -> Vec<Column> {
    let wave = |function: &str, order: &str| Column::Formula(format!("{function}({order} * {angle}){times}"));
    orders.iter().map(AsRef::as_ref).flat_map(|order| [wave("cos", order), wave("sin", order)]).collect()
}

/// Names of the orders of a form: `harmonic`, `harmonic_2` and so on.
pub fn orders(form: &FittedForm) -> Vec<String> {
    (1..=form.shape).map(|k| if k == 1 { "harmonic".to_owned() } else { format!("harmonic_{k}") }).collect()
}
