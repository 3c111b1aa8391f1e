//! Deviation of the stage from its commanded pose.

use jointbench_instrument::clock::Timed;
use jointbench_instrument::roles::Pose;

/// Deviation of the stage from its commanded pose over all readings.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct PoseDeviation {
    readings: u32,
    off_m: f64,
    off_rad: f64,
    uncertainty_s: f64,
}

impl PoseDeviation {
    pub fn add(before: Option<Self>, commanded: Pose, reached: &Timed<Pose>) -> Self {
        let before = before.unwrap_or_default();
        let off = |commanded: [f64; 3], reached: [f64; 3]| {
            commanded.iter().zip(reached).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        Self {
            readings: before.readings + 1,
            off_m: before.off_m.max(off(commanded.shift_m, reached.value.shift_m)),
            off_rad: before.off_rad.max(off(commanded.rotation_rad, reached.value.rotation_rad)),
            uncertainty_s: before.uncertainty_s.max(reached.uncertainty_s),
        }
    }

    /// Text for users.
    pub fn note(self) -> String {
        format!(
            "Stage position after settling ({} readings, time uncertainty ±{:.2} ms): within {:.2} µm and {:.1} µrad \
             of the target.",
            self.readings,
            1e3 * self.uncertainty_s,
            1e6 * self.off_m,
            1e6 * self.off_rad
        )
    }
}
