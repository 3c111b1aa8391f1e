//! One decision for runs that are judged sample by sample: what is missing, what is left, and how sure that is.
//!
//! Nothing here knows a kind of run. Preparation brings the form error, effects bring their forms, and what shows only in
//! transients says so by its regime.

pub(crate) mod evidence;
pub(crate) mod functions;
pub(crate) mod ground;
pub(crate) mod intervals;
pub(crate) mod layout;
pub(crate) mod limits;
pub(crate) mod report;
pub(crate) mod search;
pub(crate) mod solution;
pub(crate) mod solved;
pub(crate) mod structure;
pub(crate) mod weights;
