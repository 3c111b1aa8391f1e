//! Scatter of friction between strokes: the lubricant film forms anew after each reversal.

use super::{Noise, Signal};

/// Rotation of the motor against the last direction after which a stroke begins (assumed).
const FILM_RAD: f64 = 0.1;

pub struct Scatter {
    /// Standard deviation.
    share: f64,
    noise: Noise,
    strokes: u64,
    is_forward: bool,
    /// Follows the motor outside a play of ±[`FILM_RAD`].
    followed_rad: f64,
    deviation: f64,
}

impl Scatter {
    pub fn new(share: f64, noise: Noise) -> Self {
        Self { share, noise, strokes: 0, is_forward: true, followed_rad: 0.0, deviation: 0.0 }
    }

    /// Deviation of the present stroke, as a fraction of Coulomb friction.
    pub fn advance(&mut self, motor_rad: f64) -> f64 {
        let before_rad = self.followed_rad;
        self.followed_rad = before_rad.clamp(motor_rad - FILM_RAD, motor_rad + FILM_RAD);
        if self.followed_rad != before_rad && (self.followed_rad > before_rad) != self.is_forward {
            self.is_forward = !self.is_forward;
            self.strokes += 1;
            self.deviation = self.share * self.noise.at(Signal::Stroke, self.strokes);
        }
        self.deviation
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_stroke_has_a_deviation_of_its_own_and_a_tremble_is_none() {
        let mut scatter = Scatter::new(0.03, Noise::new(1));
        let mut ends = [5.0, -5.0].into_iter().cycle();
        let strokes: Vec<f64> = ends.by_ref().take(400).map(|end_rad| scatter.advance(end_rad)).collect();
        let variance = strokes.iter().map(|one| one * one).sum::<f64>() / strokes.len() as f64;
        assert!((0.027..0.033).contains(&variance.sqrt()), "{}", variance.sqrt());
        let before = scatter.advance(-5.0);
        assert_eq!([-4.95, -5.0, -4.9].map(|motor_rad| scatter.advance(motor_rad)), [before; 3]);
    }
}
