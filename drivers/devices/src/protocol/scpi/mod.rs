//! SCPI as the Rigol DP800 series speaks it (DP800 programming guide). Channel 1 feeds the brake.
//!
//! Sets have no reply, so every set travels with a question for the error queue. Which number a supply picks for a mistake
//! differs between makers: any entry but 0 is a failure. An unknown query gets no reply at all.

mod requests;

pub use requests::{
    ClearStatus, Condition, ERROR_QUEUE_DEPTH, Identify, Measured, QueryError, QueryNumber, QueryOutput, ReadCondition,
    ReadMeasured, ReadVoltage, Set, SwitchOff, Terminator,
};
