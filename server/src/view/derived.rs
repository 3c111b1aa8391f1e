//! Channels and spectra that are computed from a run.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// How large a sine at each frequency would have to be (Welch's method, Hann windows that overlap by half).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SpectrumView {
    /// As the formula was written.
    pub name: String,
    /// Of the amplitude; `null` where nothing is known of it.
    pub unit: Option<String>,
    pub frequency_hz: Vec<f64>,
    /// Amplitude of a sine at each frequency.
    pub amplitude: Vec<f64>,
    /// Windows that were averaged.
    pub windows: u64,
}
