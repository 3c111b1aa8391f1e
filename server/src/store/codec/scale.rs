//! Candidate steps of which a column may consist of integer counts.

/// Conversion of a count to a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    /// value = count × step
    Times(f64),
    /// value = count ÷ parts: printed decimals, which a multiplication does not reproduce.
    Over(f64),
}

/// Largest count: beyond it [`Scale::count`] does not round.
const LARGEST: f64 = (1u64 << 50) as f64;
/// Adding this to |x| < 2^51 places the nearest integer in the low bits of the sum.
const ROUNDER: f64 = 6_755_399_441_055_744.0;
/// Largest k of the tested scales 1 ÷ 10^k: nine significant digits from microunits upwards.
const DECIMALS: i32 = 15;
/// Values that are tested before the whole column.
const PROBES: usize = 64;

impl Scale {
    /// The nearest count. Undefined outside of ±2^50.
    #[inline(always)]
    pub fn count(self, value: f64, inverse: f64) -> i64 {
        ((value * inverse + ROUNDER).to_bits() as i64).wrapping_sub(ROUNDER.to_bits() as i64)
    }

    /// The factor of [`Scale::count`].
    pub fn inverse(self) -> f64 {
        match self {
            Scale::Times(step) => 1.0 / step,
            Scale::Over(parts) => parts,
        }
    }

    #[inline(always)]
    pub fn value(self, count: i64) -> f64 {
        // Inverse of `count`. Unlike a conversion, this can be vectorized.
        let whole = f64::from_bits(count.wrapping_add(ROUNDER.to_bits() as i64) as u64) - ROUNDER;
        match self {
            Scale::Times(step) => whole * step,
            Scale::Over(parts) => whole / parts,
        }
    }

    /// Difference between the true value and the count's value, in units in the last place.
    pub fn misses(self, value: f64, inverse: f64) -> Option<i8> {
        if (value * inverse).abs() < LARGEST {
            let nearest = self.value(self.count(value, inverse));
            i8::try_from(value.to_bits().wrapping_sub(nearest.to_bits()) as i64).ok()
        } else {
            None
        }
    }

    fn is_sane(self) -> bool {
        let inverse = self.inverse();
        inverse.is_normal() && (1.0 / inverse).is_normal() && inverse > 0.0
    }
}

/// Candidate scales, best first: those that match every probe, then those within a few last places.
pub fn candidates(values: &[f64], resolution: Option<f64>) -> Vec<Scale> {
    let declared = resolution.into_iter().flat_map(|step| [Scale::Times(step), Scale::Over((1.0 / step).round())]);
    let decimals = (0..=DECIMALS).map(|digits| Scale::Over(10f64.powi(digits)));
    let stride = values.len().div_ceil(PROBES).max(1);
    // An odd stride avoids aliasing with a periodic column.
    let probes: Vec<f64> = values.iter().copied().step_by(stride | 1).collect();
    let few = probes.len() / 16;

    let (mut hits, mut near) = (Vec::new(), Vec::new());
    for scale in declared.chain(decimals).filter(|scale| scale.is_sane()) {
        let inverse = scale.inverse();
        let misses = probes.iter().map(|value| scale.misses(*value, inverse));
        let (off, lost) = misses.fold((0, 0), |(off, lost), miss| match miss {
            Some(0) => (off, lost),
            Some(_) => (off + 1, lost),
            None => (off, lost + 1),
        });
        if lost <= few {
            if off == 0 { hits.push(scale) } else { near.push(scale) }
        }
        if hits.len() == 2 {
            break;
        }
    }
    hits.extend(near);
    hits
}
