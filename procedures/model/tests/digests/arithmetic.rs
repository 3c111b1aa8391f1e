//! Rounding of standard library functions on this machine.

use super::answers::digest;

/// First line of a file of digests: equal if sines, powers and logarithms are equal to the last bit.
pub fn line() -> String {
    let functions: [fn(f64) -> f64; 9] =
        [f64::sin, f64::cos, f64::tan, f64::atan, f64::exp, f64::ln, f64::tanh, f64::cbrt, |x| x.powf(0.37)];
    let values = (1..2000).flat_map(|i| functions.map(|f| f(0.013 * f64::from(i)).to_bits().to_string()));
    format!("# arithmetic {}", digest(&values.collect::<Vec<_>>().join(" ")))
}
