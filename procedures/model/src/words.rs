//! Figures and units in texts.

use jointbench_instrument::Kind;
use jointbench_instrument::units::quantity_of;

/// Factor and prefix of a unit for which `size` has one to three digits before the point. The prefix of a square is squared:
/// 1 mrad² is 10⁻⁶ rad², up to six digits before the point.
pub fn prefix(size: f64, unit: &str) -> (f64, &'static str) {
    if unit.starts_with("rad²") {
        let (scale, prefix) = prefix(size.sqrt(), "rad");
        return (scale * scale, prefix);
    }
    match size {
        s if s == 0.0 || s >= 1.0 => (1.0, ""),
        s if s >= 1e-3 => (1e3, "m"),
        s if s >= 1e-6 => (1e6, "µ"),
        _ => (1e9, "n"),
    }
}

/// Factor and prefix of a value of this size; none for a unit without prefixes.
fn prefix_of(size: f64, unit: &str) -> (f64, &'static str) {
    if is_prefixed(unit) { prefix(size, unit) } else { (1.0, "") }
}

/// The text of a number with the typographic minus sign.
pub fn with_minus(number: &str) -> String {
    number.replace('-', "−")
}

/// Replaces the hyphen before each separate number of a sentence by a minus sign; commands contain no such numbers.
pub fn signed(text: &str) -> String {
    let mut text_with_minus = String::with_capacity(text.len());
    let mut before = ' ';
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        let is_sign = letter == '-' && " ([".contains(before) && letters.peek().is_some_and(char::is_ascii_digit);
        text_with_minus.push(if is_sign { '−' } else { letter });
        before = letter;
    }
    text_with_minus
}

/// A value with its unit, three digits, and a prefix: `6.1 mNm`. The unit `1` is omitted.
pub fn figure(value: f64, unit: &str) -> String {
    let unit = if unit == "1" { "" } else { unit };
    let size = value.abs();
    let (scale, prefix) = prefix_of(size, unit);
    let scaled = value * scale;
    if scaled != 0.0 && scaled.abs() < 0.01 {
        return format!("{} {prefix}{unit}", small(scaled)).trim_end().to_owned();
    }
    let digits = match scaled.abs() {
        s if s >= 100.0 => 0,
        s if s >= 10.0 => 1,
        _ => 2,
    };
    let number = with_minus(&format!("{scaled:.digits$}"));
    format!("{number} {prefix}{unit}").trim_end().to_owned()
}

/// Three digits of a number below 0.01: `0.00206`, and `4.10·10⁻⁵` below 0.001.
fn small(value: f64) -> String {
    if value.abs() < 9.995e-4 { scientific(value, 2) } else { with_minus(&format!("{value:.5}")) }
}

/// A number with a power of ten and this many decimals: `4.10·10⁻⁵`.
pub fn scientific(value: f64, decimals: usize) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let text = format!("{value:.decimals$e}");
    let Some((number, exponent)) = text.split_once('e') else { return text };
    let raised = exponent.chars().map(|c| c.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]));
    format!("{}·10{}", with_minus(number), raised.collect::<String>())
}

/// The prefixed unit of one figure, for others in the same sentence.
pub struct Scale {
    scale: f64,
    unit: String,
}

impl Scale {
    /// The unit in which `value` is written.
    pub fn of(value: f64, unit: &str) -> Self {
        let (scale, prefix) = prefix_of(value.abs(), unit);
        let unit = if unit == "1" { "" } else { unit };
        Self { scale, unit: format!("{prefix}{unit}") }
    }

    /// The unit of the largest value, or of the smallest if that would be below a tenth of the unit.
    pub fn of_all(values: &[f64], unit: &str) -> Self {
        let (small, large) = values.iter().fold((f64::INFINITY, 0.0), |(s, l), v| (v.abs().min(s), v.abs().max(l)));
        let of_large = Self::of(large, unit);
        if small * of_large.scale < 0.1 { Self::of(small, unit) } else { of_large }
    }

    /// The unit with its prefix; empty for a pure number.
    pub fn unit(&self) -> &str {
        &self.unit
    }

    /// Three digits and the unit.
    pub fn figure(&self, value: f64) -> String {
        format!("{} {}", self.number(value), self.unit).trim_end().to_owned()
    }

    /// Three digits.
    pub fn number(&self, value: f64) -> String {
        let scaled = value * self.scale;
        let digits = match scaled.abs() {
            s if s >= 100.0 => 0,
            s if s >= 10.0 => 1,
            s if s >= 1.0 || s == 0.0 => 2,
            s if s >= 0.1 => 3,
            s if s >= 0.01 => 4,
            _ => return small(scaled),
        };
        with_minus(&format!("{scaled:.digits$}"))
    }
}

/// Whether sentences write this unit with a prefix.
pub fn is_prefixed(unit: &str) -> bool {
    unit.starts_with("Nm") || unit.starts_with("rad") || unit == "N" || unit == "m"
}

/// A share in percent, with one digit below 10 %: `6.1 %`, `18 %`.
pub fn percent(share: f64) -> String {
    let text = match share {
        // Rounded, nearly nothing and nearly all would look like nothing and all.
        _ if share > 0.0 && share < 0.0005 => "less than 0.1 %".to_owned(),
        _ if (0.9995..1.0).contains(&share) => "over 99.9 %".to_owned(),
        _ if share.abs() < 0.0995 || (0.995..1.0).contains(&share) => format!("{:.1} %", 100.0 * share),
        _ => format!("{:.0} %", 100.0 * share),
    };
    with_minus(&text)
}

/// `a`, `a and b`, `a, b and c`.
pub fn list(items: &[impl AsRef<str>]) -> String {
    match items {
        [] => String::new(),
        [one] => one.as_ref().to_owned(),
        [rest @ .., last] => {
            let rest: Vec<&str> = rest.iter().map(AsRef::as_ref).collect();
            format!("{} and {}", rest.join(", "), last.as_ref())
        }
    }
}

/// A column's name without its unit, for a sentence.
pub fn spoken(column: &str) -> String {
    let quantity = column.strip_suffix("_rad_s3").or_else(|| quantity_of(column));
    quantity.unwrap_or(column).replace('_', " ")
}

/// The same for an axis of a run; in a brake run the direction is that of the current.
pub fn spoken_axis(axis: &str, kind: Kind) -> String {
    match (kind, axis) {
        (Kind::Brake, "direction") => "direction of the current".into(),
        (Kind::Brake, "time_since_reversal_s") => "time since the current turned".into(),
        _ => spoken(axis),
    }
}

/// A direction in words: of the motion, or of the current of a brake.
pub fn direction_text(kind: Kind, positive: bool) -> &'static str {
    match (kind, positive) {
        (Kind::Brake, true) => "while the current rises",
        (Kind::Brake, false) => "while the current falls",
        (_, true) => "in positive motion",
        (_, false) => "in negative motion",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_read_well() {
        assert_eq!(figure(-0.00612, "Nm"), "−6.12 mNm");
        assert_eq!(figure(95.106, "kg"), "95.1 kg");
        assert_eq!(figure(1.17e-4, "rad²"), "117 mrad²");
        assert_eq!(figure(0.226, "1"), "0.23");
        assert_eq!(figure(-0.00123, "kg·m²"), "−0.00123 kg·m²");
        assert_eq!(percent(0.184), "18 %");
        assert_eq!(list(&["a", "b", "c"]), "a, b and c");
    }

    #[test]
    fn figures_of_one_sentence_share_their_unit() {
        let scale = Scale::of(3.24e-3, "Nm");
        assert_eq!((scale.figure(3.24e-3), scale.figure(0.629e-3)), ("3.24 mNm".into(), "0.629 mNm".into()));
        assert_eq!(scale.figure(3.28e-5), "0.0328 mNm");
        assert_eq!(Scale::of(95.1, "1").figure(0.5), "0.500");
        assert_eq!(Scale::of_all(&[3.24e-3, 6.31e-4], "Nm").figure(6.31e-4), "0.631 mNm");
        assert_eq!(Scale::of_all(&[1.3, 4.68e-3], "Nm").figure(1.3), "1300 mNm");
        assert_eq!(Scale::of(1.0, "Nm").figure(4e-4), "4.00·10⁻⁴ Nm");
        assert_eq!([small(9.994e-4), small(9.996e-4), small(-1.2e-12)], ["9.99·10⁻⁴", "0.00100", "−1.20·10⁻¹²"]);
        assert_eq!(scientific(2.5e9, 3), "2.500·10⁹");
    }

    #[test]
    fn columns_are_spoken_without_their_units() {
        assert_eq!(spoken("motor_velocity_rad_s"), "motor velocity");
        assert_eq!(spoken("time_since_reversal_s"), "time since reversal");
        assert_eq!(spoken("repeat"), "repeat");
        assert_eq!(spoken_axis("direction", Kind::Brake), "direction of the current");
        assert_eq!(spoken_axis("direction", Kind::Friction), "direction");
    }
}
