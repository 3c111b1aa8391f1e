//! Zero-phase filters: applied forwards and backwards, so that no signal is delayed against another one.
//!
//! Analogue prototypes and bilinear transform after Oppenheim and Schafer, Discrete-Time Signal Processing, ch. 7.
//! They are second-order sections, because a transfer function of order 8 is numerically inaccurate.

use std::f64::consts::PI;

/// One second-order section, a₀ = 1.
#[derive(Debug, Clone, Copy)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

/// Columns that are filtered together.
pub const ABREAST: usize = 4;

/// A low-pass filter, to be applied in both directions.
#[derive(Debug, Clone)]
pub struct LowPass {
    sections: Vec<Section>,
}

impl LowPass {
    /// Butterworth of even order. `corner` is the share of half the sample rate, within (0, 1).
    pub fn butterworth(order: usize, corner: f64) -> Self {
        let poles = |k: usize| {
            let angle = PI * (2 * k + 1) as f64 / (2 * order) as f64;
            (-angle.sin(), angle.cos())
        };
        Self::from_poles((0..order / 2).map(poles), corner)
    }

    /// Sections from one pole of each conjugate pair, all zeros at half the sample rate.
    fn from_poles(poles: impl Iterator<Item = (f64, f64)>, corner: f64) -> Self {
        let warped = 2.0 * (PI * corner / 2.0).tan();
        let sections = poles.map(|(re, im)| {
            let (re, im) = (re * warped / 2.0, im * warped / 2.0);
            // z = (1 + s)/(1 − s) with s in units of twice the sample rate.
            let scale = (1.0 - re) * (1.0 - re) + im * im;
            let a1 = -2.0 * (1.0 - re * re - im * im) / scale;
            let a2 = ((1.0 + re) * (1.0 + re) + im * im) / scale;
            let k = (1.0 + a1 + a2) / 4.0;
            Section { b: [k, 2.0 * k, k], a: [a1, a2] }
        });
        Self { sections: sections.collect() }
    }

    /// Filters forwards and backwards. The ends are continued point-symmetrically by `pad` samples.
    pub fn both_ways(&self, values: &[f64], pad: usize) -> Vec<f64> {
        let [filtered] = self.abreast([values], pad);
        filtered
    }

    /// The same for many columns of one length.
    pub fn each_both_ways(&self, columns: &[&[f64]], pad: usize) -> Vec<Vec<f64>> {
        let some = |some: &[&[f64]]| match *some {
            [a, b, c, d] => self.abreast([a, b, c, d], pad).into(),
            [a, b, c] => self.abreast([a, b, c], pad).into(),
            [a, b] => self.abreast([a, b], pad).into(),
            _ => some.iter().map(|c| self.both_ways(c, pad)).collect::<Vec<_>>(),
        };
        columns.chunks(ABREAST).flat_map(some).collect()
    }

    /// Each sample depends on the one before it. Several columns are filtered together to use the processor's
    /// pipelines.
    fn abreast<const N: usize>(&self, columns: [&[f64]; N], pad: usize) -> [Vec<f64>; N] {
        let n = columns.iter().map(|c| c.len()).min().unwrap_or(0);
        if n < 2 {
            return columns.map(<[f64]>::to_vec);
        }
        let pad = pad.min(n - 1);
        let mirrored = |end: usize, i: usize| columns.map(|c| 2.0 * c[end] - c[i]);
        let mut x: Vec<[f64; N]> = Vec::with_capacity(n + 2 * pad);
        x.extend((1..=pad).rev().map(|i| mirrored(0, i)));
        x.extend((0..n).map(|i| columns.map(|c| c[i])));
        x.extend((1..=pad).map(|i| mirrored(n - 1, n - 1 - i)));
        for _ in 0..2 {
            self.one_way(&mut x);
            x.reverse();
        }
        std::array::from_fn(|column| x[pad..pad + n].iter().map(|v| v[column]).collect())
    }

    /// One pass from rest at the first value.
    fn one_way<const N: usize>(&self, x: &mut [[f64; N]]) {
        // Two sections at once: the second processes one sample while the first is at the next.
        for pair in self.sections.chunks(2) {
            match pair {
                [first, second] => pass([*first, *second], x),
                rest => rest.iter().for_each(|section| pass([*section], x)),
            }
        }
    }
}

fn pass<const N: usize, const S: usize>(sections: [Section; S], x: &mut [[f64; N]]) {
    // Steady state for a constant at the first value (all sections have unit gain at zero frequency).
    let rest = x[0];
    let mut state = sections.map(|Section { b, a }| [rest.map(|v| v * (1.0 - b[0])), rest.map(|v| v * (b[2] - a[1]))]);
    for values in x.iter_mut() {
        for (Section { b, a }, [s1, s2]) in sections.iter().zip(&mut state) {
            for ((v, s1), s2) in values.iter_mut().zip(s1).zip(s2) {
                let input = *v;
                let output = b[0] * input + *s1;
                *s1 = b[1] * input - a[0] * output + *s2;
                *s2 = b[2] * input - a[1] * output;
                *v = output;
            }
        }
    }
}

/// Derivative by central differences on unevenly timed samples, one-sided at the ends.
pub fn derivative(time_s: &[f64], values: &[f64]) -> Vec<f64> {
    let n = values.len();
    if n < 2 {
        return vec![0.0; n];
    }
    (0..n)
        .map(|i| {
            let (low, high) = (i.saturating_sub(1), (i + 1).min(n - 1));
            (values[high] - values[low]) / (time_s[high] - time_s[low])
        })
        .collect()
}

/// Applies a function to every recording on its own and joins the results.
pub fn by_recording(
    values: &[f64],
    starts: &[usize],
    f: impl Fn(std::ops::Range<usize>, &[f64]) -> Vec<f64>,
) -> Vec<f64> {
    let mut joined = Vec::with_capacity(values.len());
    let ends = starts.iter().skip(1).copied().chain([values.len()]);
    for (start, end) in starts.iter().zip(ends) {
        joined.append(&mut f(*start..end, &values[*start..end]));
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(n: usize, share_of_nyquist: f64) -> Vec<f64> {
        (0..n).map(|i| (PI * share_of_nyquist * i as f64).sin()).collect()
    }

    fn check_gain(filter: &LowPass, share: f64, expected: f64, budget: f64) {
        let x = wave(4000, share);
        let y = filter.both_ways(&x, 100);
        let rms = |v: &[f64]| (v[1000..3000].iter().map(|a| a * a).sum::<f64>() / 2000.0).sqrt();
        let gain = rms(&y) / rms(&x);
        assert!((gain - expected).abs() < budget, "at {share}: {gain}, expected {expected}");
    }

    #[test]
    fn butterworth_passes_halves_and_stops() {
        let filter = LowPass::butterworth(4, 0.2);
        check_gain(&filter, 0.02, 1.0, 1e-3);
        check_gain(&filter, 0.2, 0.5, 1e-3);
        check_gain(&filter, 0.6, 0.0, 1e-3);
    }

    #[test]
    fn a_constant_stays_and_a_line_is_not_delayed() {
        let filter = LowPass::butterworth(4, 0.1);
        let y = filter.both_ways(&[3.0; 50], 12);
        assert!(y.iter().all(|v| (v - 3.0).abs() < 1e-9));
        let line: Vec<f64> = (0..200).map(f64::from).collect();
        let y = filter.both_ways(&line, 90);
        assert!((y[100] - 100.0).abs() < 1e-6, "{}", y[100]);
    }

    #[test]
    fn columns_side_by_side_are_filtered_as_each_alone() {
        let filter = LowPass::butterworth(8, 0.2);
        let waves: Vec<Vec<f64>> = (1..=7).map(|k| wave(300, 0.05 * f64::from(k))).collect();
        for count in 1..=7 {
            let some: Vec<&[f64]> = waves[..count].iter().map(Vec::as_slice).collect();
            let alone: Vec<Vec<f64>> = some.iter().map(|w| filter.both_ways(w, 24)).collect();
            assert_eq!(filter.each_both_ways(&some, 24), alone);
        }
    }
}
