//! How much later than the joint the torque sensor is read, by the bench's clock.

use jointbench_instrument::clock::between;
use jointbench_instrument::roles::JointReading;
use jointbench_instrument::skew::Skew;

/// All skews of a run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Skews {
    least_s: f64,
    most_s: f64,
    uncertainty_s: f64,
}

/// Of a reading that was asked for and came between two moments.
pub(super) fn of(joint: &JointReading, asked_s: f64, heard_s: f64) -> Skew {
    let (at_s, uncertainty_s) = between(asked_s, heard_s);
    Skew { s: at_s - joint.at_s, uncertainty_s: uncertainty_s + joint.uncertainty_s }
}

impl Skews {
    pub fn add(before: Option<Self>, Skew { s, uncertainty_s }: Skew) -> Self {
        let before = before.unwrap_or(Self { least_s: s, most_s: s, uncertainty_s });
        Self {
            least_s: before.least_s.min(s),
            most_s: before.most_s.max(s),
            uncertainty_s: before.uncertainty_s.max(uncertainty_s),
        }
    }

    /// For people. `None` where the clock stood still between the two, as that of a mock bench without a pace does.
    pub fn told(self) -> Option<String> {
        let Self { least_s, most_s, uncertainty_s } = self;
        (most_s > 0.0).then(|| {
            format!(
                "the torque sensor was read {:.2} to {:.2} ms after the joint, each known to ±{:.2} ms or better; \
                 column torque_skew_s has it for every row",
                1e3 * least_s,
                1e3 * most_s,
                1e3 * uncertainty_s
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointbench_instrument::units::{Amperes, RadPerSec, Radians};

    #[test]
    fn what_is_told_holds_for_every_reading() {
        let joint = JointReading {
            at_s: 10.0,
            uncertainty_s: 0.5e-3,
            motor_position: Radians(0.0),
            motor_velocity: RadPerSec(0.0),
            motor_current: Amperes(0.0),
            link_position: None,
        };
        let first = of(&joint, 10.001, 10.002);
        assert!((first.s - 1.5e-3).abs() < 1e-9 && (first.uncertainty_s - 1e-3).abs() < 1e-9, "{first:?}");
        let skews = Skews::add(Some(Skews::add(None, first)), of(&joint, 10.001, 10.005));
        let told = skews.told().unwrap();
        assert!(told.contains("1.50 to 3.00 ms") && told.contains("±2.50 ms"), "{told}");
        let still = JointReading { uncertainty_s: 0.0, ..joint };
        assert_eq!(Skews::add(None, of(&still, 10.0, 10.0)).told(), None);
    }
}
