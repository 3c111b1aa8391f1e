//! Errors of a bench.

#[derive(Debug, Clone, thiserror::Error)]
pub enum BenchError {
    /// A run is active or not yet stored.
    #[error("{0}")]
    Busy(String),
    /// An instrument or the worker does not work as required.
    #[error("{0}")]
    Instrument(String),
    /// The joint has no servo with a readable memory.
    #[error("{0}")]
    NoServo(String),
}
