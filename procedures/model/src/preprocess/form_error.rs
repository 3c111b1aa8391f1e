//! Where the error of a formula lives: columns that stand beside every model of a run that is judged sample by sample.
//!
//! A formula is right but for a few percent, and what it is wrong by follows its own axes: the way since a reversal, the lag
//! of sensors and a gear that bends. Beside these columns an effect has to explain what no error of the others could be.

/// What a column stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lives {
    /// In the way since a reversal: one element that remembers, without the direction of the model.
    Bristle,
    /// In the change of the jerk: a gear that bends between motor and link.
    Snap,
    /// In the jerk: torque and motion that are not of one moment.
    Jerk,
    /// In the change of the load: a torque sensor that lags.
    LoadRate,
}

impl Lives {
    pub fn name(self) -> &'static str {
        match self {
            Lives::Bristle => "bristle",
            Lives::Snap => "snap",
            Lives::Jerk => "jerk",
            Lives::LoadRate => "load_rate",
        }
    }

    /// Its factor is held near zero: such columns are many and resemble the model.
    pub fn shrinks(self) -> bool {
        self == Lives::Bristle
    }
}

/// One column at the rows.
#[derive(Debug, Clone)]
pub struct ErrorColumn {
    pub lives: Lives,
    pub values: Vec<f64>,
    /// Its size, by which it is held near zero.
    pub scale: f64,
}

/// The columns of a problem, and how its rows are weighed.
#[derive(Debug, Clone)]
pub struct FormError {
    pub columns: Vec<ErrorColumn>,
    /// Time to the nearest reversal or rest at the rows [s].
    pub turn_s: Vec<f64>,
    /// The filter carries a reversal over this time [s].
    pub near_s: f64,
    /// Sizes of acceleration and jerk at the rows: where they are large a model errs more.
    pub swift: [Vec<f64>; 2],
    /// Step from row to row [s].
    pub row_s: f64,
    /// Step of the run's own samples [s].
    pub sample_s: f64,
}
