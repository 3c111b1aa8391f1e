//! Poles that remain in a rotor when the current falls at standstill. Rotation under a falling current removes them.

use super::branches::rising;
use std::f64::consts::TAU;

/// Poles per turn (drawing of the data sheet: one tooth every 17°).
const POLES: f64 = 21.0;
/// Fraction of the torque last held (assumed: 5 to 10 %).
const COGGING: f64 = 0.06;
/// Rotation over which a field magnetises the rotor again: one pole pitch (assumed).
const MEMORY_RAD: f64 = TAU / POLES;

/// Currents and torques as fractions of the rating.
#[derive(Default)]
pub struct Poles {
    /// The current at which the rotor was magnetised.
    held: f64,
    /// Angle of the poles.
    seat_rad: f64,
}

impl Poles {
    /// Torque on a rotor that has turned by `turned_rad` to `angle_rad` at `current`.
    ///
    /// If the field is at least as strong as before, the poles follow it. A weaker field removes them more slowly, and
    /// at standstill it does not remove them.
    pub fn advance(&mut self, current: f64, angle_rad: f64, turned_rad: f64) -> f64 {
        if current >= self.held {
            (self.held, self.seat_rad) = (current, angle_rad);
            return 0.0;
        }
        let renewed = turned_rad.abs() / MEMORY_RAD * current / self.held;
        self.held += (current - self.held) * renewed.min(1.0);
        let visible = COGGING * (rising(self.held) - rising(current));
        visible * (POLES * (angle_rad - self.seat_rad)).sin()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEPS: u32 = 40_000;

    /// Ramps the current during rotation, then turns once without current. Returns the peak-to-peak torque of that
    /// turn.
    fn ramp(poles: &mut Poles, from: f64, to: f64, turns: f64) -> f64 {
        let step_rad = turns * TAU / f64::from(STEPS);
        let mut angle_rad = 0.0;
        for step in 1..=STEPS {
            angle_rad += step_rad;
            poles.advance(from + (to - from) * f64::from(step) / f64::from(STEPS), angle_rad, step_rad);
        }
        let once_rad = TAU / f64::from(STEPS);
        let torques = (0..STEPS).map(|_| {
            angle_rad += once_rad;
            poles.advance(to, angle_rad, once_rad)
        });
        let (low, high) = torques.fold((0.0, 0.0), |(low, high): (f64, f64), t| (low.min(t), high.max(t)));
        high - low
    }

    #[test]
    fn a_decrease_at_standstill_cogs_until_it_is_ramped_down_while_turning() {
        let mut poles = Poles::default();
        assert_eq!(ramp(&mut poles, 0.0, 0.8, 0.0), 0.0, "a rise leaves nothing");
        assert_eq!(ramp(&mut poles, 0.8, 0.8, 2.0), 0.0, "nor does a constant current through stop and start");
        let cogging = ramp(&mut poles, 0.8, 0.0, 0.0);
        assert!((0.09..0.11).contains(&cogging), "{cogging} of the rating");
        assert!(ramp(&mut poles, 0.0, 0.0, 5.0) > 0.99 * cogging, "turning alone does not remove it");
        ramp(&mut poles, 0.0, 0.8, 0.0);
        let left = ramp(&mut poles, 0.8, 0.0, 3.0);
        assert!(left < 0.005, "{left} of the rating after the ramp");
    }
}
