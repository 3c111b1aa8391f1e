//! SCPI as supplies of the Rigol DP800 and the R&S HMP series speak it. Channel 1 feeds the brake.
//!
//! Sets have no reply, so every set travels with a question for the error queue. Which number a supply picks for a mistake
//! differs between makers: any entry but 0 is a failure. An unknown query gets no reply at all.

mod dialect;
mod requests;

pub use dialect::Dialect;
pub use requests::{
    ClearStatus, Condition, ERROR_QUEUE_DEPTH, Identify, Measured, QueryError, QueryFlag, QueryNumber, ReadCondition,
    ReadMeasured, ReadVoltage, Set, SwitchOff, Terminator,
};
