//! SCPI of the supplies of the Rigol DP800, R&S HMP and Kepco BOP series. Channel 1 feeds the brake.
//!
//! Set commands have no reply, so each is sent together with a query of the error queue. The error numbers differ
//! between makers: any entry except 0 is a failure. An unknown query gets no reply at all.

mod dialect;
mod requests;

pub use dialect::Dialect;
pub use requests::{
    ClearStatus, Condition, ERROR_QUEUE_DEPTH, Identify, Measured, QueryError, QueryFlag, QueryNumber, ReadCondition,
    ReadMeasured, ReadVoltage, Set, SwitchOff, Terminator,
};
