//! Error of the look-up table, whose entries are few, relative to the smoothed error over the turn.

use super::spectrum::last_order;
use super::sweeps::Sweep;
use super::table::{Class, Table, Terms};
use crate::findings::{jackknife95, quantity};
use crate::identification::Quantity;
use jointbench_model::thresholds::ALPHA;
use std::f64::consts::{LN_2, TAU};

/// Positions in each entry at which table and smoothed error are compared.
const IN_ENTRY: usize = 8;
/// Mean and maximum difference (rad) between the table and the smoothed error.
#[derive(Debug, Clone, Copy)]
pub struct Reduction {
    mean: Bounded,
    max: Bounded,
}

#[derive(Debug, Clone, Copy)]
struct Bounded {
    rad: f64,
    /// By a jackknife over the turns of each sweep; `None` below three turns.
    ci95: Option<[f64; 2]>,
}

impl Reduction {
    /// `sweeps` and `terms` are those of the table.
    pub fn of(table: &Table, sweeps: &[Sweep], terms: &Terms) -> Self {
        let orders = significant(table);
        let [mean, max] = difference_rad(table, &orders);
        let classes: Vec<Class> = sweeps.iter().map(Class::of).collect();
        let turns = classes.iter().map(Class::turns).min().unwrap_or(0);
        let without = |turn| {
            let others: Vec<Sweep> = classes.iter().map(|class| class.without(turn)).collect();
            Table::of(&others, terms, table.len()).map(|table| difference_rad(&table, &orders))
        };
        let parts: Option<Vec<[f64; 2]>> = (turns >= 3).then(|| (0..turns).map(without).collect()).flatten();
        let bounded = |rad: f64, i: usize| {
            let reach = parts.as_ref().map(|parts| jackknife95(&parts.iter().map(|part| part[i]).collect::<Vec<_>>()));
            Bounded { rad, ci95: reach.map(|reach| [(rad - reach).max(0.0), rad + reach]) }
        };
        Self { mean: bounded(mean, 0), max: bounded(max, 1) }
    }

    /// In radians, and in points of the encoder under test.
    pub fn quantities(self, point_rad: Option<f64>) -> Vec<Quantity> {
        let named = [("mean", "Mean", self.mean), ("max", "Maximum", self.max)];
        let of = |(name, title, value): (&str, &str, Bounded)| {
            let title = format!("{title} difference between table and smoothed error");
            let rad = quantity([&format!("table_error_{name}"), "", &title, "rad"], value.rad, value.ci95);
            let points = point_rad.map(|point_rad| {
                let name = format!("table_error_{name}_points");
                let ends = value.ci95.map(|ends| ends.map(|end| end / point_rad));
                quantity([&name, "", &format!("{title} (points)"), ""], value.rad / point_rad, ends)
            });
            std::iter::once(rad).chain(points)
        };
        named.into_iter().flat_map(of).collect()
    }
}

/// Orders of the table whose amplitude noise does not explain. The median over all orders estimates the noise, because
/// few orders have a cause.
fn significant(table: &Table) -> Vec<u32> {
    let squares: Vec<f64> = (1..=last_order(table)).map(|order| table.harmonic(order).powi(2)).collect();
    let mut sorted = squares.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or_default();
    // The squared amplitude of noise has an exponential distribution.
    let limit = median / LN_2 * (squares.len() as f64 / ALPHA).ln();
    (1..).zip(squares).filter(|(_, square)| *square > limit).map(|(order, _)| order).collect()
}

/// Mean and maximum of the absolute difference over the turn.
fn difference_rad(table: &Table, orders: &[u32]) -> [f64; 2] {
    let step_rad = TAU / table.len() as f64;
    let waves: Vec<(f64, [f64; 2])> = orders
        .iter()
        .map(|order| {
            // An entry is a mean over its step, which flattens the wave.
            let half_step = 0.5 * f64::from(*order) * step_rad;
            (f64::from(*order), table.wave(*order).map(|part| part * half_step / half_step.sin()))
        })
        .collect();
    let mean_rad = table.mean();
    let smoothed = |angle: f64| {
        let wave = |(order, [cos, sin]): &(f64, [f64; 2])| cos * (order * angle).cos() + sin * (order * angle).sin();
        mean_rad + waves.iter().map(wave).sum::<f64>()
    };
    let positions = IN_ENTRY * table.len();
    let (sum, max) = (0..positions).fold((0.0, 0.0_f64), |(sum, max), i| {
        let angle = (i as f64 + 0.5) * TAU / positions as f64;
        let difference = (table.at(angle) - smoothed(angle)).abs();
        (sum + difference, max.max(difference))
    });
    [sum / positions as f64, max]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wave within 64 pole pairs, read at many angles of whole turns in both directions at two speeds, with errors of
    /// the reference in equal steps up to `noise_rad`.
    fn sweeps(noise_rad: f64) -> [Sweep; 4] {
        [5.0, -5.0, 50.0, -50.0].map(|speed_rad_s| {
            let angle_rad: Vec<f64> = (0..80_000).map(|i| f64::from(i) * 8.0 * TAU / 80_000.0).collect();
            let noise = |i: usize| noise_rad * (2.0 * ((i * 7919 % 1009) as f64 / 1008.0) - 1.0);
            let error_rad = angle_rad.iter().enumerate().map(|(i, a)| 3e-6 * (64.0 * a).cos() + noise(i)).collect();
            Sweep { repeat: 0, speed_rad_s, error_rad, angle_rad, radial_m: 0.0 }
        })
    }

    fn reduction(sweeps: &[Sweep], size: usize) -> Reduction {
        let terms = Terms::of(sweeps).unwrap();
        Reduction::of(&Table::of(sweeps, &terms, size).unwrap(), sweeps, &terms)
    }

    /// Without noise: the mean over a step flattens the wave by (kh)²/24 and the line between entries by up to (kh)²/8,
    /// where kh is the phase of a step.
    #[test]
    fn fewer_entries_have_a_larger_error() {
        let sweeps = sweeps(0.0);
        for size in [1024, 512] {
            let found = reduction(&sweeps, size);
            let phase = 64.0 * TAU / size as f64;
            let expected_rad = 3e-6 * phase.powi(2) * (1.0 / 24.0 + 1.0 / 8.0);
            assert!((found.max.rad / expected_rad - 1.0).abs() < 0.15, "{size}: {found:?}, expected {expected_rad:e}");
            assert!(found.mean.rad < 0.6 * found.max.rad, "{size}: {found:?}");
        }
    }

    #[test]
    fn noise_of_the_entries_belongs_to_the_error_and_more_turns_reduce_it() {
        let sweeps = sweeps(1e-4);
        let few: Vec<Sweep> = sweeps
            .iter()
            .map(|sweep| {
                let half = sweep.angle_rad.len() / 4;
                let [angle_rad, error_rad] = [&sweep.angle_rad, &sweep.error_rad].map(|all| all[..half].to_vec());
                Sweep { angle_rad, error_rad, ..sweep.clone() }
            })
            .collect();
        let (few, many) = (reduction(&few, 1024), reduction(&sweeps, 1024));
        assert!(few.mean.rad > 1.5 * many.mean.rad, "{few:?} {many:?}");
        assert!(few.mean.ci95.is_none(), "two turns have no jackknife");
        let [low, high] = many.mean.ci95.unwrap();
        assert!(low > 0.0 && low < many.mean.rad && many.mean.rad < high, "{many:?}");
    }

    #[test]
    fn points_are_those_of_the_encoder() {
        let quantities = reduction(&sweeps(1e-4), 512).quantities(Some(TAU / 262_144.0));
        let names: Vec<&str> = quantities.iter().map(|quantity| quantity.name.as_str()).collect();
        assert_eq!(names, ["table_error_mean", "table_error_mean_points", "table_error_max", "table_error_max_points"]);
        let [rad, points] = [&quantities[0], &quantities[1]];
        assert!((points.value * TAU / 262_144.0 - rad.value).abs() < 1e-12);
        assert_eq!(reduction(&sweeps(0.0), 512).quantities(None).len(), 2);
    }
}
