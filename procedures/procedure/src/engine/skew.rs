//! Delay between the readings of two instruments, by the bench's clock; negative if a stream has sent the reading
//! earlier.

use jointbench_instrument::clock::Timed;
use jointbench_instrument::roles::JointReading;
use jointbench_instrument::skew::Skew;

/// Range of all delays of a run.
#[derive(Debug, Clone, Copy)]
pub(super) struct SkewRange {
    least_s: f64,
    most_s: f64,
    pub uncertainty_s: f64,
}

pub(super) fn of<T>(joint: &JointReading, reading: &Timed<T>) -> Skew {
    Skew { s: reading.at_s - joint.at_s, uncertainty_s: reading.uncertainty_s + joint.uncertainty_s }
}

impl SkewRange {
    pub fn add(before: Option<Self>, Skew { s, uncertainty_s }: Skew) -> Self {
        let before = before.unwrap_or(Self { least_s: s, most_s: s, uncertainty_s });
        Self {
            least_s: before.least_s.min(s),
            most_s: before.most_s.max(s),
            uncertainty_s: before.uncertainty_s.max(uncertainty_s),
        }
    }

    /// Text for users. `None` if the clock did not advance between the readings, as on a mock bench without real
    /// time.
    pub fn note(self) -> Option<String> {
        let Self { least_s, most_s, .. } = self;
        if (least_s, most_s) == (0.0, 0.0) {
            return None;
        }
        Some(format!("Torque samples are {} than the joint samples. See column torque_skew_s.", self.span()))
    }

    /// As in "1 to 2 ms (±0.1 ms) later".
    pub fn span(self) -> String {
        let [least_ms, most_ms, known_ms] = [self.least_s, self.most_s, self.uncertainty_s].map(|s| 1e3 * s);
        let known = format!("(±{known_ms:.2} ms)");
        if least_ms < 0.0 && most_ms <= 0.0 {
            return format!("{:.2} to {:.2} ms {known} earlier", most_ms.abs(), -least_ms);
        }
        format!("{least_ms:.2} to {most_ms:.2} ms {known} later")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointbench_instrument::units::{Amperes, RadPerSec, Radians};

    #[test]
    fn the_note_holds_for_every_reading() {
        let joint = JointReading {
            at_s: 10.0,
            uncertainty_s: 0.5e-3,
            motor_position: Radians(0.0),
            motor_velocity: RadPerSec(0.0),
            motor_current: Amperes(0.0),
            link_position: None,
        };
        let delayed = |at_s: f64, uncertainty_s: f64| of(&joint, &Timed { value: (), at_s, uncertainty_s });
        let first = delayed(10.0015, 0.5e-3);
        assert!((first.s - 1.5e-3).abs() < 1e-9 && (first.uncertainty_s - 1e-3).abs() < 1e-9, "{first:?}");
        let skews = SkewRange::add(Some(SkewRange::add(None, first)), delayed(10.003, 2e-3));
        let note = skews.note().unwrap();
        assert!(note.contains("1.50 to 3.00 ms") && note.contains("±2.50 ms"), "{note}");
        let still = JointReading { uncertainty_s: 0.0, ..joint };
        let now = Timed { value: (), at_s: 10.0, uncertainty_s: 0.0 };
        assert_eq!(SkewRange::add(None, of(&still, &now)).note(), None);
        let streamed = SkewRange::add(Some(SkewRange::add(None, delayed(9.997, 1e-4))), delayed(9.998, 1e-4));
        assert!(streamed.note().unwrap().contains("2.00 to 3.00 ms (±0.60 ms) earlier"), "{streamed:?}");
    }
}
