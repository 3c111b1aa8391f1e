//! Which whole counts could a column be made of?

/// How a value comes from a count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    /// value = count × step
    Times(f64),
    /// value = count ÷ parts: decimals as they are printed, which no product reproduces.
    Over(f64),
}

/// Largest count: beyond it [`Scale::count`] does not round any more.
const LARGEST: f64 = (1u64 << 50) as f64;
/// Adding this to |x| < 2^51 leaves the nearest whole number in the low bits of the sum.
const ROUNDER: f64 = 6_755_399_441_055_744.0;
/// 1 ÷ 10^k is tried for k up to this: nine significant digits from microunits upwards.
const DECIMALS: i32 = 15;
/// Values looked at before a scale is tried on the whole column.
const PROBES: usize = 64;

impl Scale {
    /// The nearest count. Meaningless outside of ±2^50.
    #[inline(always)]
    pub fn count(self, value: f64, inverse: f64) -> i64 {
        ((value * inverse + ROUNDER).to_bits() as i64).wrapping_sub(ROUNDER.to_bits() as i64)
    }

    /// What [`Scale::count`] multiplies by.
    pub fn inverse(self) -> f64 {
        match self {
            Scale::Times(step) => 1.0 / step,
            Scale::Over(parts) => parts,
        }
    }

    #[inline(always)]
    pub fn value(self, count: i64) -> f64 {
        // The way of `count` back: unlike a conversion, it is done for several values at once.
        let whole = f64::from_bits(count.wrapping_add(ROUNDER.to_bits() as i64) as u64) - ROUNDER;
        match self {
            Scale::Times(step) => whole * step,
            Scale::Over(parts) => whole / parts,
        }
    }

    /// Units in the last place from the count's value to the true one.
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

/// The scales worth trying, best first: those that hit every probe, then those that come within a few last places.
pub fn candidates(values: &[f64], resolution: Option<f64>) -> Vec<Scale> {
    let told = resolution.into_iter().flat_map(|step| [Scale::Times(step), Scale::Over((1.0 / step).round())]);
    let decimals = (0..=DECIMALS).map(|digits| Scale::Over(10f64.powi(digits)));
    let stride = values.len().div_ceil(PROBES).max(1);
    // An odd stride does not fall in step with a periodic column.
    let probes: Vec<f64> = values.iter().copied().step_by(stride | 1).collect();
    let few = probes.len() / 16;

    let (mut hits, mut near) = (Vec::new(), Vec::new());
    for scale in told.chain(decimals).filter(|scale| scale.is_sane()) {
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
