//! Figures of a parameter: value and interval in one unit.

use super::figure;
use crate::report::in_one_unit;

/// Texts of a table.
#[derive(Debug, PartialEq, Eq)]
pub struct Cells {
    pub value: String,
    /// With its prefix; empty for a dimensionless number.
    pub unit: String,
    pub interval: String,
}

/// A selected integer, a known value, and a parameter without influence on the run have no interval.
pub fn cells(value: f64, ci95: [f64; 2], unit: &str) -> Cells {
    let [low, high] = ci95;
    if low == high {
        let (value, interval) = if low == 0.0 { ("–".to_owned(), "–") } else { (figure(value), "no interval") };
        return Cells { value, unit: plain(unit), interval: interval.to_owned() };
    }
    if !(low.is_finite() && high.is_finite()) {
        let interval = format!("{} … {}", figure(low), figure(high));
        return Cells { value: figure(value), unit: plain(unit), interval };
    }
    let (value, unit, ends) = in_one_unit(value, Some(ci95), unit);
    Cells { value, unit, interval: ends.unwrap_or_default() }
}

/// Dimensionless numbers have no unit.
fn plain(unit: &str) -> String {
    if unit == "1" { String::new() } else { unit.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::cells;

    #[test]
    fn a_prefix_replaces_an_exponent() {
        for (value, ci95, unit, expected) in [
            (0.0306, [0.0300, 0.0312], "Nm", ["30.60", "mNm", "30.00 … 31.20"]),
            (4.2e-5, [4.05e-5, 4.35e-5], "Nm·s/rad", ["42.0", "µNm·s/rad", "40.5 … 43.5"]),
            (1.2e-5, [1.1e-5, 1.3e-5], "kg·m²", ["1.200·10⁻⁵", "kg·m²", "1.100·10⁻⁵ … 1.300·10⁻⁵"]),
            (0.820308, [0.820306, 0.82031], "1", ["0.8203080", "", "0.8203060 … 0.8203100"]),
            (7.0, [7.0, 7.0], "1", ["7.000", "", "no interval"]),
            (0.0, [0.0, 0.0], "Nm", ["–", "Nm", "–"]),
            (0.03, [0.02, f64::INFINITY], "Nm", ["0.03000", "Nm", "0.02000 … ∞"]),
        ] {
            let found = cells(value, ci95, unit);
            assert_eq!([found.value, found.unit, found.interval], expected, "{value} {unit}");
        }
    }
}
