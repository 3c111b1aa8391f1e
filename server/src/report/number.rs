//! Numbers for print: as many digits as the interval justifies.

use jointbench_model::words;

/// Whether this unit can have a prefix. In a table, currents, times and voltages have one too.
fn takes_prefix(unit: &str) -> bool {
    words::is_prefixed(unit) || ["A", "s", "V"].contains(&unit)
}

/// `32.14 mNm` and `31.90 … 32.38`: one unit, and two digits of the half-width.
pub fn with_interval(value: f64, ci95: Option<[f64; 2]>, unit: &str) -> (String, Option<String>) {
    let (shown, unit, ends) = in_one_unit(value, ci95, unit);
    (format!("{shown} {unit}").trim_end().to_owned(), ends)
}

/// The same with the unit apart, for a table.
pub fn in_one_unit(value: f64, ci95: Option<[f64; 2]>, unit: &str) -> (String, String, Option<String>) {
    let unit = if unit == "1" { "" } else { unit };
    let (factor, prefix) = if takes_prefix(unit) { words::prefix(value.abs(), unit) } else { (1.0, "") };
    let spread = ci95.map_or(value.abs() / 50.0, |[low, high]| (high - low) / 2.0) * factor;
    let text = |value: f64| {
        let (sign, size) = if value < 0.0 { ("−", -value) } else { ("", value) };
        format!("{sign}{}", digits(size * factor, spread))
    };
    let ends = ci95.map(|[low, high]| format!("{} … {}", text(low), text(high)));
    (text(value), format!("{prefix}{unit}"), ends)
}

/// Rounds to two digits of `spread`.
fn digits(value: f64, spread: f64) -> String {
    if spread <= 0.0 || !spread.is_finite() {
        return if value == value.round() && value.abs() < 1e9 { format!("{value:.0}") } else { format!("{value:.4}") };
    }
    let places = (1.0 - spread.log10().floor()).clamp(0.0, 12.0) as usize;
    match value.abs() {
        size if size >= 1e9 || (size > 0.0 && size < 1e-4) => words::scientific(value, 3),
        _ => format!("{value:.places$}"),
    }
}

#[cfg(test)]
mod tests {
    use super::with_interval;

    #[test]
    fn an_interval_decides_the_digits() {
        for (value, ci95, unit, shown, interval) in [
            (0.032_141, Some([0.0319, 0.0324]), "Nm", "32.14 mNm", Some("31.90 … 32.40")),
            (5000.4, Some([4980.0, 5020.0]), "Nm/rad", "5000 Nm/rad", Some("4980 … 5020")),
            (1.17e-4, Some([2.7e-5, 2.06e-4]), "rad²", "117 mrad²", Some("27 … 206")),
            (0.27, None, "", "0.2700", None),
            (11.0, None, "", "11.00", None),
            (1.2e-5, Some([1.1e-5, 1.3e-5]), "kg·m²", "1.200·10⁻⁵ kg·m²", Some("1.100·10⁻⁵ … 1.300·10⁻⁵")),
            (0.0, Some([0.0, 0.0]), "Nm", "0 Nm", Some("0 … 0")),
            (-2.0, Some([-2.5, 0.5]), "V", "−2.0 V", Some("−2.5 … 0.5")),
        ] {
            let (text, ends) = with_interval(value, ci95, unit);
            assert_eq!((text.as_str(), ends.as_deref()), (shown, interval));
        }
    }
}
