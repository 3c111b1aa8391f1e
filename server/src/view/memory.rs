//! The memory of a joint's servo.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The memory of the servo of a joint, read between runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ServoMemory {
    pub variables: Vec<MemoryVariable>,
}

/// One variable of the memory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MemoryVariable {
    /// First address.
    pub address: u8,
    pub name: String,
    /// From the first address on, read one after the other: a variable that changes may be torn.
    pub bytes: Vec<u8>,
    /// `null` for a buffer of several values.
    pub value: Option<f64>,
    /// Value with unit, or in hexadecimal digits; the states of the status word.
    pub shown: String,
    pub unit: String,
    pub meaning: String,
}
