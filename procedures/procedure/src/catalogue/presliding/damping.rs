//! Bristle damping σ₁ of LuGre, from the time by which the displacement is behind the torque.
//!
//! With τ = σ₀z + σ₁ż the bristles follow the torque as a low-pass with the time constant σ₁/σ₀, and the displacement
//! follows the bristles without delay. Drive and encoder delay it too. Their delay is known to two control periods, so
//! that a shorter time constant gives an upper limit only.

use super::dahl::{Dahl, top_nm};
use super::loops::{Swings, dahl};
use crate::findings::{jackknife95, quantity, solve};
use crate::identification::Quantity;
use crate::thresholds::SAME_AMPLITUDE;
use jointbench_model::words;

const ROUNDS: usize = 8;
/// Steps of the numerical derivatives: a share of each parameter, and rows.
const SHARE: f64 = 1e-5;
const ROWS: f64 = 0.1;
/// Control periods to which the delay of drive and encoder is known: one for the command, one for the reading.
const KNOWN_ROWS: f64 = 2.0;
/// Amplitudes that the interval needs.
const AMPLITUDES: usize = 3;

/// Damping of the bristles, with what the delay of the instruments contributes.
pub struct Damping {
    /// Estimate, and its interval if it is larger than the delay of the instruments may be [Nm·s/rad].
    value: Option<(f64, [f64; 2])>,
    /// Upper end of the interval in any case.
    most: f64,
}

impl Damping {
    /// From all steps, the fit without damping, and the interval of its stiffness. `None`: too few amplitudes.
    ///
    /// Delete-one-amplitude jackknife, because what the model lacks depends on the amplitude and is the same in all its
    /// steps.
    pub fn of(held: &[&Swings], at: Dahl, stiffness: [f64; 2], rate_hz: f64) -> Option<Self> {
        let rows = constant_rows(held, at)?;
        let without = |amplitude_nm: &f64| {
            let others: Vec<&Swings> =
                held.iter().copied().filter(|swings| !is_same(top_nm(&[*swings]), *amplitude_nm)).collect();
            constant_rows(&others, at)
        };
        let jackknife: Vec<f64> = amplitudes_nm(held).iter().filter_map(without).collect();
        if jackknife.len() < AMPLITUDES {
            return None;
        }
        let reach = jackknife95(&jackknife) + KNOWN_ROWS;
        let [low, high] = [rows - reach, rows + reach].map(|rows| rows / rate_hz);
        let value = (low > 0.0).then(|| (at.stiffness() * rows / rate_hz, [stiffness[0] * low, stiffness[1] * high]));
        Some(Self { value, most: stiffness[1] * high.max(0.0) })
    }

    pub fn quantities(&self) -> Vec<Quantity> {
        let limit = ["sigma_1_most", "σ₁", "Upper limit of the bristle damping (LuGre)", "Nm·s/rad"];
        let found = ["sigma_1", "σ₁", "Bristle damping (LuGre), including viscous friction", "Nm·s/rad"];
        match self.value {
            Some((value, ci95)) => vec![quantity(found, value, Some(ci95))],
            None => vec![quantity(limit, self.most, None)],
        }
    }

    /// A sentence for the summary.
    pub fn words(&self) -> String {
        match self.value {
            Some((value, _)) => format!(" Bristle damping {}.", words::figure(value, "Nm·s/rad")),
            None => format!(
                " Bristle damping is not determined by this run: less than {} (95 %), because delays of drive and encoder look \
                 the same.",
                words::figure(self.most, "Nm·s/rad")
            ),
        }
    }
}

fn is_same(a_nm: f64, b_nm: f64) -> bool {
    (a_nm - b_nm).abs() < SAME_AMPLITUDE * a_nm.max(b_nm)
}

/// Each amplitude of the steps once.
fn amplitudes_nm(held: &[&Swings]) -> Vec<f64> {
    let mut known: Vec<f64> = Vec::new();
    for swings in held {
        let amplitude_nm = top_nm(&[*swings]);
        if !known.iter().any(|known_nm| is_same(*known_nm, amplitude_nm)) {
            known.push(amplitude_nm);
        }
    }
    known
}

/// The time constant, in rows. The other parameters are fitted again, because a low-pass changes the width of the loops
/// as friction does. Gauss–Newton with halved steps.
fn constant_rows(all: &[&Swings], from: Dahl) -> Option<f64> {
    let top_nm = top_nm(all);
    let (mut at, mut rows) = (from, 0.0);
    let mut left = residuals(all, at, rows);
    for _ in 0..ROUNDS {
        let sizes = at.sizes(top_nm).map(|size| SHARE * size);
        let slopes = [0, 1, 2].map(|i| {
            let mut by = [0.0; 3];
            by[i] = sizes[i];
            residuals(all, at.shifted(by, 1.0, top_nm), rows)
        });
        let slower = residuals(all, at, rows + ROWS);
        let slope = |k: usize, i: usize| (left[k] - slopes[i][k]) / SHARE;
        let row = |k: usize| [slope(k, 0), slope(k, 1), slope(k, 2), (left[k] - slower[k]) / ROWS];
        let matrix: Vec<[f64; 4]> = (0..left.len()).map(row).collect();
        let step = solve(&matrix, &left)?.values;
        let by = [0, 1, 2].map(|i| step[i] * sizes[i] / SHARE);
        let tried = [1.0, 0.5, 0.25, 0.125].into_iter().find_map(|share| {
            let next = (at.shifted(by, share, top_nm), rows + share * step[3]);
            let next_left = residuals(all, next.0, next.1);
            (sum(&next_left) < sum(&left)).then_some((next, next_left))
        });
        let Some((next, next_left)) = tried else { break };
        let is_done = sum(&next_left) > (1.0 - 1e-6) * sum(&left);
        ((at, rows), left) = (next, next_left);
        if is_done {
            break;
        }
    }
    Some(rows)
}

fn sum(left: &[f64]) -> f64 {
    left.iter().map(|error| error * error).sum()
}

/// Measured minus modelled displacement, without the mean of each step.
fn residuals(all: &[&Swings], at: Dahl, rows: f64) -> Vec<f64> {
    let mut left = Vec::new();
    for swings in all {
        let way = dahl(&low_pass(&swings.torque_nm, rows), at.coulomb_nm, at.bias_nm);
        let start = left.len();
        left.extend(swings.points.iter().map(|(row, q)| q - at.compliance * way[*row]));
        let mean = left[start..].iter().sum::<f64>() / (left.len() - start).max(1) as f64;
        left[start..].iter_mut().for_each(|error| *error -= mean);
    }
    left
}

/// First-order low-pass, exact for a signal that is linear between rows. A time constant below 0, which noise can give,
/// is a lead.
fn low_pass(signal: &[f64], rows: f64) -> Vec<f64> {
    let keep = if rows > 0.0 { (-1.0 / rows).exp() } else { 0.0 };
    let mut state = signal.first().copied().unwrap_or_default();
    let mut before = state;
    let follow = |value: &f64| {
        let rise = value - before;
        state = value - rows * rise + (state - before + rows * rise) * keep;
        before = *value;
        state
    };
    signal.iter().map(follow).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 250.0;
    const AT: Dahl = Dahl { compliance: 1.0 / 15.0, coulomb_nm: 0.030, bias_nm: 0.0 };

    /// Two cycles of a triangle of 4 s; the bristles follow the torque with the time constant, by the exact solution of
    /// σ₁ż = τ − σ₀z in steps of a hundredth of a row. Edges of counts are `count_rad` apart.
    fn step(top_nm: f64, constant_s: f64, count_rad: f64) -> Swings {
        let rows = (8.0 * RATE_HZ) as usize;
        let torque = |t_s: f64| {
            let phase = (t_s / 4.0).fract();
            top_nm
                * if phase < 0.25 {
                    4.0 * phase
                } else if phase < 0.75 {
                    2.0 - 4.0 * phase
                } else {
                    4.0 * phase - 4.0
                }
        };
        let fine = 100;
        let step_s = 1.0 / (RATE_HZ * f64::from(fine));
        let keep = if constant_s > 0.0 { (-step_s / constant_s).exp() } else { 0.0 };
        let (mut carried_nm, mut q, mut edge, mut points) = (0.0_f64, 0.0_f64, 0.0_f64, Vec::new());
        for row in 0..rows {
            let before = edge;
            for part in 0..fine {
                let target_nm = torque((row as f64 + f64::from(part) / f64::from(fine)) / RATE_HZ);
                let next_nm = target_nm + (carried_nm - target_nm) * keep;
                let moved_nm = next_nm - carried_nm;
                q += AT.compliance * moved_nm / (1.0 - carried_nm * moved_nm.signum() / AT.coulomb_nm);
                carried_nm = next_nm;
                edge = (q / count_rad).floor();
            }
            // With two edges in one row the time of the first crossing is unknown.
            if (edge - before).abs() == 1.0 {
                points.push((row, count_rad * edge.max(before)));
            }
        }
        let torque_nm = (0..rows).map(|row| torque((row as f64 + 0.5) / RATE_HZ)).collect();
        Swings { torque_nm, points, broke_away: false }
    }

    fn damping(constant_s: f64) -> Damping {
        let steps: Vec<Swings> = (0..12)
            .map(|i| step(0.028 - 0.003 * f64::from(i % 4), constant_s, 3e-4 * (1.0 + 0.07 * f64::from(i))))
            .collect();
        let held: Vec<&Swings> = steps.iter().collect();
        Damping::of(&held, AT, [14.99, 15.01], RATE_HZ).unwrap()
    }

    #[test]
    fn damping_beyond_the_delay_of_instruments_has_an_interval_that_contains_it() {
        // σ₁/σ₀ = 20 ms, five control periods.
        let (value, [low, high]) = damping(0.020).value.unwrap();
        assert!((value - 0.30).abs() < 0.015, "{value}");
        assert!(low < 0.30 && 0.30 < high && high - low < 0.3, "{low} {high}");
    }

    #[test]
    fn damping_within_the_delay_of_instruments_has_an_upper_limit_only() {
        for constant_s in [0.0, 0.002] {
            let damping = damping(constant_s);
            assert!(damping.value.is_none() && damping.words().contains("is not determined by this run"));
            assert!(damping.most >= 15.0 * constant_s && damping.most < 0.25, "{}", damping.most);
            let names: Vec<String> = damping.quantities().into_iter().map(|quantity| quantity.name).collect();
            assert_eq!(names, ["sigma_1_most"]);
        }
    }
}
