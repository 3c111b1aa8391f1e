//! Names with their unit, in plain ASCII.

/// `rad/s²` becomes `rad_s2`; `1` becomes nothing.
pub fn of(unit: &str) -> String {
    if unit == "1" {
        return String::new();
    }
    let plain = unit.chars().filter_map(|c| match c {
        '²' => Some('2'),
        '³' => Some('3'),
        '°' => None,
        c if c.is_ascii_alphanumeric() => Some(c.to_ascii_lowercase()),
        _ => Some('_'),
    });
    plain.collect()
}

/// `velocity` in `rad/s` becomes `velocity_rad_s`.
pub fn named(name: &str, unit: &str) -> String {
    let unit = of(unit);
    if unit.is_empty() { name.to_owned() } else { format!("{name}_{unit}") }
}

/// Text in ASCII that does not end a C comment.
pub fn ascii(text: &str) -> String {
    const POWERS: [char; 11] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹', '⁻'];
    let mut plain = String::with_capacity(text.len());
    let mut is_power = false;
    for c in text.chars() {
        if let Some(power) = POWERS.iter().position(|power| *power == c) {
            if !std::mem::replace(&mut is_power, true) {
                plain.push('^');
            }
            plain.push(char::from(b"0123456789-"[power]));
            continue;
        }
        is_power = false;
        match c {
            '·' => plain.push('*'),
            '−' | '–' => plain.push('-'),
            '…' => plain.push_str("..."),
            '°' => plain.push_str("deg "),
            c if c.is_ascii() && !c.is_ascii_control() => plain.push(c),
            c if c.is_whitespace() => plain.push(' '),
            _ => plain.push('?'),
        }
    }
    plain.replace("*/", "* /").replace("/*", "/ *")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_become_suffixes() {
        for (unit, suffix) in [("rad/s²", "rad_s2"), ("Nm", "nm"), ("kg·m²", "kg_m2"), ("°C", "c"), ("1", "")] {
            assert_eq!(of(unit), suffix);
        }
        assert_eq!(named("direction", "1"), "direction");
        assert_eq!(ascii("4.00·10⁻¹² kg·m²"), "4.00*10^-12 kg*m^2");
    }
}
