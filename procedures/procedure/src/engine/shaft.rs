//! Delays between instruments that measure the position of one shaft, by the bench's clock and by their readings.
//!
//! Only instruments on one shaft are compared. Torque and current of one motion differ by friction, compliance and
//! the drive's control, so that a lag between them is physical.

use super::skew::SkewRange;
use crate::encoder_columns::Encoders;
use crate::findings::{Lag, ReadingPair, lag};
use jointbench_instrument::roles::JointReading;
use jointbench_instrument::skew::Skew;

/// More rows do not improve the estimate of a lag.
const MOST_ROWS: usize = 50_000;

/// One instrument compared with the reference encoder.
#[derive(Debug, Clone, Default)]
struct Pair {
    readings: Vec<ReadingPair>,
    skews: Option<SkewRange>,
}

#[derive(Debug, Clone, Default)]
pub(super) struct Shaft {
    motor: Pair,
    test: Pair,
}

impl Shaft {
    pub fn add(&mut self, stretch: u32, joint: &JointReading, encoders: &Encoders) {
        let Encoders { reference, test, .. } = encoders;
        let motor = (joint.at_s, joint.uncertainty_s, joint.motor_position.0);
        let test = (test.at_s, test.uncertainty_s, test.position.0);
        for (pair, (at_s, uncertainty_s, rad)) in [(&mut self.motor, motor), (&mut self.test, test)] {
            if pair.readings.len() == MOST_ROWS {
                continue;
            }
            let skew = Skew { s: at_s - reference.at_s, uncertainty_s: uncertainty_s + reference.uncertainty_s };
            pair.skews = Some(SkewRange::add(pair.skews, skew));
            let (first_s, first_rad) = (reference.at_s, reference.position.0);
            pair.readings.push(ReadingPair { stretch, first_s, first_rad, second_s: at_s, second_rad: rad });
        }
    }

    /// Texts for users. Empty without two instruments on one shaft.
    pub fn notes(&self) -> Vec<String> {
        let motor = ("the motor's own encoder", &self.motor, UNKNOWN);
        let test = ("the encoder under test", &self.test, OWN);
        let note =
            |(name, pair, beyond): (&str, &Pair, &str)| Some(note(name, pair.skews?, lag(&pair.readings), beyond));
        [motor, test].into_iter().filter_map(note).collect()
    }
}

/// Cause of a lag that the time stamps do not show.
const UNKNOWN: &str = "Unrecorded latency: check filters, buffers and adapters";
const OWN: &str = "Cause: delay of this encoder (measure it with encoder_delay) or an unrecorded latency";

fn note(name: &str, skews: SkewRange, lag: Option<Lag>, beyond: &str) -> String {
    let by_clock = format!("Skew of {name} by time stamps: {} than the reference encoder.", skews.span());
    let Some(Lag { s, reach_s }) = lag else {
        return format!("{by_clock} The signals do not determine it, because the motion is too small or too uniform.");
    };
    let side = if s < 0.0 { "leads" } else { "lags" };
    let by_signals = format!("By the signals it {side} by a further {:.4} ± {:.4} ms", 1e3 * s.abs(), 1e3 * reach_s);
    let verdict = if s.abs() <= reach_s + skews.uncertainty_s { "Time stamps and signals agree" } else { beyond };
    format!("{by_clock} {by_signals}. {verdict}.")
}
