//! Numbers for print: as many digits as the interval justifies, or the own digits of a setting.

use jointbench_model::words;

/// Factor and prefixed unit for values of this size. In tables and figures, currents, times, voltages and powers have a
/// prefix too. The unit `1` is omitted.
pub(super) fn scale(size: f64, unit: &str) -> (f64, String) {
    let unit = if unit == "1" { "" } else { unit };
    let is_prefixed = words::is_prefixed(unit) || ["A", "s", "V", "W"].contains(&unit);
    let (factor, prefix) = if is_prefixed { words::prefix(size, unit) } else { (1.0, "") };
    (factor, format!("{prefix}{unit}"))
}

/// A setting with its own digits, at most seven: `40.6 mNm/A`. Whole numbers without a prefix are exact.
pub(super) fn with_own_digits(value: f64, unit: &str) -> String {
    let (factor, unit) = scale(value.abs(), unit);
    let scaled = value * factor;
    let rounded = if scaled.fract() == 0.0 { scaled } else { format!("{scaled:.6e}").parse().unwrap_or(scaled) };
    let number = if (1e-4..1e15).contains(&rounded.abs()) || rounded == 0.0 {
        words::with_minus(&rounded.to_string())
    } else {
        let text = format!("{rounded:e}");
        let fraction = text.split_once('e').and_then(|(mantissa, _)| mantissa.split_once('.'));
        words::scientific(rounded, fraction.map_or(0, |(_, digits)| digits.len()))
    };
    format!("{number} {unit}").trim_end().to_owned()
}

/// `32.14 mNm` and `31.90 … 32.38`: one unit, chosen by the largest of these numbers, and two digits of the half-width.
pub fn with_interval(value: f64, ci95: Option<[f64; 2]>, unit: &str) -> (String, Option<String>) {
    let (shown, unit, ends) = in_one_unit(value, ci95, unit);
    (format!("{shown} {unit}").trim_end().to_owned(), ends)
}

/// The same with the unit apart, for a table.
pub fn in_one_unit(value: f64, ci95: Option<[f64; 2]>, unit: &str) -> (String, String, Option<String>) {
    let ends = ci95.iter().flatten().filter(|end| end.is_finite());
    let largest = ends.fold(value.abs(), |largest, end| largest.max(end.abs()));
    let (factor, unit) = scale(largest, unit);
    let spread = ci95.map_or(value.abs() / 50.0, |[low, high]| (high - low) / 2.0) * factor;
    let text = |value: f64| words::with_minus(&digits(value * factor, spread, largest * factor));
    let ends = ci95.map(|[low, high]| format!("{} … {}", text(low), text(high)));
    (text(value), unit, ends)
}

/// Rounds to two digits of `spread`, in the notation of the largest number of the row.
fn digits(value: f64, spread: f64, largest: f64) -> String {
    if spread <= 0.0 || !spread.is_finite() {
        return if value == value.round() && value.abs() < 1e9 { format!("{value:.0}") } else { format!("{value:.4}") };
    }
    let places = (1.0 - spread.log10().floor()).clamp(0.0, 12.0) as usize;
    match value {
        _ if (1e-4..1e9).contains(&largest) => format!("{value:.places$}"),
        0.0 => "0".to_owned(),
        _ => words::scientific(value, 3),
    }
}

#[cfg(test)]
mod tests {
    use super::{with_interval, with_own_digits};

    #[test]
    fn a_setting_has_its_own_digits_and_a_prefix() {
        for (value, unit, shown) in [
            (0.0406, "Nm/A", "40.6 mNm/A"),
            (1.2e-5, "kg·m²", "1.2·10⁻⁵ kg·m²"),
            (10.0 * std::f64::consts::PI, "rad", "31.41593 rad"),
            (-0.25, "A", "−250 mA"),
            (250.0, "Hz", "250 Hz"),
            (123_456_789_012.0, "", "123456789012"),
            (0.0, "1", "0"),
        ] {
            assert_eq!(with_own_digits(value, unit), shown);
        }
    }

    #[test]
    fn an_interval_decides_the_digits() {
        for (value, ci95, unit, shown, interval) in [
            (0.032_141, Some([0.0319, 0.0324]), "Nm", "32.14 mNm", Some("31.90 … 32.40")),
            (5000.4, Some([4980.0, 5020.0]), "Nm/rad", "5000 Nm/rad", Some("4980 … 5020")),
            (1.17e-4, Some([2.7e-5, 2.06e-4]), "rad²", "117 mrad²", Some("27 … 206")),
            (0.27, None, "", "0.2700", None),
            (11.0, None, "", "11.00", None),
            (1.2e-5, Some([1.1e-5, 1.3e-5]), "kg·m²", "1.200·10⁻⁵ kg·m²", Some("1.100·10⁻⁵ … 1.300·10⁻⁵")),
            (1.2e-5, Some([0.0, 2.4e-5]), "kg·m²", "1.200·10⁻⁵ kg·m²", Some("0 … 2.400·10⁻⁵")),
            (1.2e-4, Some([8e-5, 1.6e-4]), "kg·m²", "0.000120 kg·m²", Some("0.000080 … 0.000160")),
            (0.0, Some([0.0, 0.0]), "Nm", "0 Nm", Some("0 … 0")),
            (-4.1e-4, Some([-0.0045, 0.0037]), "Nm", "−0.4 mNm", Some("−4.5 … 3.7")),
            (-2.0, Some([-2.5, 0.5]), "V", "−2.0 V", Some("−2.5 … 0.5")),
        ] {
            let (text, ends) = with_interval(value, ci95, unit);
            assert_eq!((text.as_str(), ends.as_deref()), (shown, interval));
        }
    }
}
