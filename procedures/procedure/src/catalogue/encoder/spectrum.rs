//! Harmonics of an error over the turn with their uncertainty, and the resulting number of pole pairs.

use super::sweeps::Sweep;
use super::table::Table;
use crate::findings::solve;
use crate::thresholds::POLE_PAIRS_APART;

/// Number of orders in the spectrum, and the lowest order of the pole pairs.
pub const ORDERS: u32 = 160;
const FIRST_POLE_PAIR: u32 = 8;
/// 95 % limit of a noise amplitude relative to the half interval of a wave's cosine and sine: √(−2 ln 0.05) standard
/// errors over 1.96.
const NOISE: f64 = 2.448 / 1.960;

/// Number of evaluated orders: those with a known cause, and two without, which show the noise level.
pub const NAMED: usize = 6;

pub struct PolePairs {
    pub order: u32,
    pub amplitude_rad: f64,
    /// The second-best order, if it is nearly as good.
    pub or: Option<u32>,
}

impl PolePairs {
    /// `None` if the table has too few entries.
    pub fn of(table: &Table) -> Option<Self> {
        let last = last_order(table);
        let best = |without: Option<u32>| {
            // A wave within the pole pair that is not sinusoidal also has multiples of its order.
            let other = move |order: &u32| without.is_none_or(|best| !order.is_multiple_of(best));
            let amplitude = |order: u32| (order, table.harmonic(order));
            (FIRST_POLE_PAIR..=last).filter(other).map(amplitude).max_by(|a, b| a.1.total_cmp(&b.1))
        };
        let (order, amplitude_rad) = best(None)?;
        let or = best(Some(order)).filter(|(_, next)| *next > POLE_PAIRS_APART * amplitude_rad).map(|(order, _)| order);
        Some(Self { order, amplitude_rad, or })
    }

    pub fn text(&self) -> String {
        match self.or {
            None => format!("{} pole pairs detected.", self.order),
            Some(or) => format!("Number of pole pairs uncertain: {} or {or}.", self.order),
        }
    }

    pub fn orders(&self) -> [(u32, &'static str); NAMED] {
        let poles = self.order;
        [
            (1, "eccentricity"),
            (2, "tilt, ellipticity"),
            (3, "unassigned"),
            (4, "unassigned"),
            (poles, "pole pairs"),
            (2 * poles, "within the pole pair"),
        ]
    }
}

/// Highest order that the table has and the spectrum shows.
pub fn last_order(table: &Table) -> u32 {
    ORDERS.min((table.len() as u32).div_ceil(2) - 1)
}

/// The amplitudes of some orders with their 95 % intervals, and the 95 % limit of noise.
pub struct Waves {
    pub amplitude_rad: [f64; NAMED],
    pub ci95: [[f64; 2]; NAMED],
    pub noise_rad: f64,
}

impl Waves {
    /// Least squares over all readings. `None` if the readings do not separate the orders.
    pub fn of(sweeps: &[Sweep], orders: [u32; NAMED], left: &dyn Fn(&Sweep, usize) -> f64) -> Option<Self> {
        let row = |angle: &f64| -> [f64; 1 + 2 * NAMED] {
            std::array::from_fn(|i| match i {
                0 => 1.0,
                _ => {
                    let phase = f64::from(orders[(i - 1) / 2]) * angle;
                    if i % 2 == 1 { phase.cos() } else { phase.sin() }
                }
            })
        };
        let rows: Vec<_> = sweeps.iter().flat_map(|sweep| sweep.angle_rad.iter().map(row)).collect();
        let errors: Vec<f64> =
            sweeps.iter().flat_map(|sweep| (0..sweep.error_rad.len()).map(|i| left(sweep, i))).collect();
        let solved = solve(&rows, &errors)?;
        let amplitude_rad = std::array::from_fn(|n| solved.values[1 + 2 * n].hypot(solved.values[2 + 2 * n]));
        let reach: [f64; NAMED] = std::array::from_fn(|n| solved.reach[1 + 2 * n].max(solved.reach[2 + 2 * n]));
        let ci95 = std::array::from_fn(|n| {
            let (value, reach): (f64, f64) = (amplitude_rad[n], reach[n]);
            [(value - reach).max(0.0), value + reach]
        });
        Some(Self { amplitude_rad, ci95, noise_rad: NOISE * reach.into_iter().fold(0.0, f64::max) })
    }
}

#[cfg(test)]
mod tests {
    use super::super::table::Terms;
    use super::*;
    use std::f64::consts::TAU;

    /// Slow turns in both directions with an error within the pole pairs and another one of nearly their order.
    fn sweeps(other_rad: f64) -> [Sweep; 4] {
        [5.0, -5.0, 50.0, -50.0].map(|speed_rad_s| {
            let angle_rad: Vec<f64> = (0..20_000).map(|i| f64::from(i) * 7.0 * TAU / 20_000.0).collect();
            let error = |a: &f64| 2e-3 * a.sin() + 3e-4 * (64.0 * a).cos() + other_rad * (57.0 * a).sin();
            Sweep { repeat: 0, speed_rad_s, error_rad: angle_rad.iter().map(error).collect(), angle_rad, radial_m: 0.0 }
        })
    }

    #[test]
    fn pole_pairs_are_sure_only_where_no_other_order_is_nearly_as_strong() {
        for (other_rad, or) in [(0.5e-4, None), (2.5e-4, Some(57))] {
            let sweeps = sweeps(other_rad);
            let table = Table::of(&sweeps, &Terms::of(&sweeps).unwrap(), 1024).unwrap();
            let poles = PolePairs::of(&table).unwrap();
            assert_eq!((poles.order, poles.or), (64, or), "{}", poles.text());
        }
    }

    #[test]
    fn waves_have_their_amplitudes_and_what_is_none_lies_below_the_noise() {
        let sweeps = sweeps(0.0);
        let named = PolePairs { order: 64, amplitude_rad: 3e-4, or: None }.orders().map(|(order, _)| order);
        // Like the counts of a coarse encoder: uniform, and unlike any wave.
        let left =
            |sweep: &Sweep, i: usize| sweep.error_rad[i] + 1e-4 * (f64::from(i as u32 * 7919 % 1000) / 1000.0 - 0.5);
        let waves = Waves::of(&sweeps, named, &left).unwrap();
        for (n, truth) in [(0, 2e-3), (4, 3e-4)] {
            let [low, high] = waves.ci95[n];
            assert!((low..=high).contains(&truth) && high - low < 3e-6, "{truth}: {low} to {high}");
        }
        assert!([1, 2, 3, 5].iter().all(|n| waves.amplitude_rad[*n] < waves.noise_rad), "{:?}", waves.amplitude_rad);
    }
}
