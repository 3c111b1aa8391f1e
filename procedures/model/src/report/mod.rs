//! Report objects for JSON output.

pub(crate) mod comparison;
pub(crate) mod diagnosis;
pub(crate) mod fit;
pub(crate) mod maps;
pub(crate) mod reasons;
pub(crate) mod residuals;
pub(crate) mod setting;
pub(crate) mod text;
pub(crate) mod upper_limits;

pub use crate::report::comparison::{Comparison, ParameterPair, WiderInterval};
pub use crate::report::diagnosis::{
    Diagnosis, Discovery, Evidence, Experiment, Imitated, NoiseFloor, Silent, Step, Suggestion, UndecidedReason,
    Verdict,
};
pub use crate::report::fit::{
    Bristles, Evaluation, Fit, FormErrorTerm, GivenConstant, MeanCurve, Parameter, ParameterState, Preparation,
    ResidualKind, Scope, SignalRange, Term, TradeOff,
};
pub use crate::report::maps::{AxisMap, MapBin, MapCell, PairMap, Region, ResidualMaps};
pub use crate::report::reasons::{
    AdditionReason, Invisible, InvisibleReason, LeftOut, LeftOutReason, RejectionReason, RemovalReason,
};
pub use crate::report::residuals::{Axis, ResidualSet};
pub use crate::report::setting::ParameterSetting;
pub use crate::report::text::TextPart;
