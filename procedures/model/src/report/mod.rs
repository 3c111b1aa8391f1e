//! What comes out: the objects of the contract, ready to be written as JSON.

mod comparison;
mod diagnosis;
mod fit;
mod maps;
mod residuals;

pub use comparison::{Comparison, ParameterPair, Wider};
pub use diagnosis::{
    Diagnosis, Discovery, Evidence, Experiment, Imitated, Invisible, LeftOut, NoiseFloor, Region, Silent, Step,
    Suggestion, Verdict,
};
pub use fit::{
    Evaluation, Fit, GivenConstant, MeanCurve, Parameter, ParameterState, Preparation, ResidualKind, Scope,
    SignalRange, Term, TradeOff,
};
pub use maps::{AxisMap, MapBin, MapCell, PairMap, ResidualMaps};
pub use residuals::{Axis, ResidualSet};
