//! Form error: nuisance columns in every model of a run that is judged sample by sample.
//!
//! A formula has an error of a few percent, which depends on known quantities: displacement since a reversal, moment of
//! the reversal, sensor delay and torsion of the gear. With these nuisance columns an effect has to explain more than
//! the form error of the others could.

/// The quantity that a form-error column depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FormErrorKind {
    /// Displacement since a reversal: one hysteresis element minus the direction of the model.
    Bristle,
    /// Rate of change of the direction of friction: a direction that changes earlier or later than the encoder shows, and
    /// the damping of the bristles (Canudas de Wit et al. 1995).
    BristleRate,
    /// Rate of change of the jerk: torsion of the gear between motor and link.
    Snap,
    /// Jerk: a time shift between torque and motion.
    Jerk,
    /// Rate of change of the load: a delay of the torque sensor.
    LoadRate,
}

impl FormErrorKind {
    pub fn name(self) -> &'static str {
        match self {
            FormErrorKind::Bristle => "bristle",
            FormErrorKind::BristleRate => "bristle_rate",
            FormErrorKind::Snap => "snap",
            FormErrorKind::Jerk => "jerk",
            FormErrorKind::LoadRate => "load_rate",
        }
    }

    /// Whether the ridge penalty shrinks the coefficient: such columns are many and resemble the model.
    pub fn is_penalised(self) -> bool {
        matches!(self, FormErrorKind::Bristle | FormErrorKind::BristleRate)
    }
}

/// One column at the rows.
#[derive(Debug, Clone)]
pub struct ErrorColumn {
    pub kind: FormErrorKind,
    pub values: Vec<f64>,
    /// RMS of the column, which scales the ridge penalty.
    pub scale: f64,
}

/// The form-error columns of a problem, and the quantities that determine its weights.
#[derive(Debug, Clone)]
pub struct FormError {
    pub columns: Vec<ErrorColumn>,
    /// Time to the nearest reversal or rest at the rows [s].
    pub turn_s: Vec<f64>,
    /// Time over which the filter spreads a reversal [s].
    pub near_s: f64,
    /// Absolute acceleration and jerk at the rows: a model has a larger error where they are large.
    pub fast: [Vec<f64>; 2],
    /// Time step from row to row [s].
    pub row_s: f64,
    /// Time step of the original samples [s].
    pub sample_s: f64,
}
