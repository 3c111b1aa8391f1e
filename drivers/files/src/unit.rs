//! Units of imported tables with their common spellings, and their values in SI.

use std::f64::consts::TAU;

/// The quantity that a unit measures. A column only accepts units of its own dimension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    Time,
    Angle,
    AngularVelocity,
    Torque,
    Current,
    Temperature,
    Length,
    Velocity,
    Force,
    Other,
}

/// A value in SI is `factor` times the value in this unit, plus `offset` (K and °F).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    pub dimension: Dimension,
    pub factor: f64,
    pub offset: f64,
}

/// Units of the inch and the pound in SI (NIST SP 811, appendix B.8).
const INCH: f64 = 0.0254;
const FOOT: f64 = 12.0 * INCH;
const LBF: f64 = 4.448_221_615_260_5;
const LBF_IN: f64 = LBF * INCH;
const LBF_FT: f64 = LBF * FOOT;
const OZF_IN: f64 = LBF_IN / 16.0;
const KGF: f64 = 9.806_65;
const DEGREE: f64 = TAU / 360.0;
pub(crate) const DAY_S: f64 = 86_400.0;
/// 0 °C in kelvin.
const ICE_K: f64 = 273.15;

type Row = (Dimension, f64, &'static [&'static str]);

/// Names as normalized by [`plain`]; the first name of each row is the preferred one.
const UNITS: [Row; 59] = {
    use Dimension as D;
    [
        (D::Time, 1.0, &["s", "sec", "secs", "second", "seconds", "sek", "sekunden"]),
        (D::Time, 1e-3, &["ms", "msec", "millisecond", "milliseconds", "millis"]),
        (D::Time, 1e-6, &["us", "usec", "microsecond", "microseconds", "micros"]),
        (D::Time, 1e-7, &["100ns"]),
        (D::Time, 1e-9, &["ns", "nsec", "nanosecond", "nanoseconds", "nanos"]),
        (D::Time, 60.0, &["min", "minute", "minutes"]),
        (D::Time, 3600.0, &["h", "hour", "hours"]),
        (D::Time, DAY_S, &["day", "days", "d"]),
        (D::Angle, 1.0, &["rad", "rads", "radian", "radians"]),
        (D::Angle, 1e-3, &["mrad"]),
        (D::Angle, 1e-6, &["urad"]),
        (D::Angle, DEGREE, &["deg", "degs", "degree", "degrees", "°"]),
        (D::Angle, DEGREE / 60.0, &["arcmin"]),
        (D::Angle, DEGREE / 3600.0, &["arcsec"]),
        (
            D::Angle,
            TAU,
            &["rev", "revs", "turn", "turns", "revolution", "revolutions", "rotation", "rotations", "umdrehungen"],
        ),
        (D::AngularVelocity, 1.0, &["rad/s", "rads/s", "rad/sec", "radians/s", "1/s", "s-1"]),
        (D::AngularVelocity, 1e-3, &["mrad/s"]),
        (D::AngularVelocity, DEGREE, &["deg/s", "°/s", "degrees/s", "deg/sec", "dps"]),
        (D::AngularVelocity, TAU / 60.0, &["rpm", "1/min", "min-1", "u/min", "rev/min", "r/min", "upm"]),
        (D::AngularVelocity, TAU, &["rev/s", "revs/s", "turn/s", "turns/s", "rps", "r/s"]),
        (D::Torque, 1.0, &["Nm", "N*m", "newtonmetre", "newtonmetres", "newtonmeters"]),
        (D::Torque, 1e-3, &["mNm", "Nmm", "mN*m", "N*mm"]),
        (D::Torque, 1e-6, &["uNm", "uN*m"]),
        (D::Torque, 1e-2, &["Ncm", "N*cm", "cNm"]),
        (D::Torque, 1e3, &["kNm", "kN*m"]),
        (D::Torque, OZF_IN, &["ozf*in", "oz*in", "ozin", "ozfin", "inoz", "in*oz"]),
        (D::Torque, LBF_IN, &["lbf*in", "lb*in", "in*lb", "inlb", "inlbs", "lbin", "in*lbs", "in*lbf"]),
        (D::Torque, LBF_FT, &["lbf*ft", "lb*ft", "ft*lb", "ftlb", "ft*lbs", "ftlbs", "ft*lbf"]),
        (D::Torque, 0.01 * KGF, &["kgf*cm", "kg*cm", "kgcm", "kgfcm"]),
        (D::Torque, KGF, &["kgf*m", "kg*m"]),
        (D::Current, 1.0, &["A", "amp", "amps", "ampere", "amperes"]),
        (D::Current, 1e-3, &["mA", "milliamp", "milliamps"]),
        (D::Current, 1e-6, &["uA"]),
        (D::Current, 1e3, &["kA"]),
        (D::Temperature, 1.0, &["°C", "C", "degC", "celsius", "degreesC", "deg_c"]),
        (D::Temperature, 1.0, &["K", "kelvin"]),
        (D::Temperature, 5.0 / 9.0, &["°F", "degF", "fahrenheit", "F", "deg_f"]),
        (D::Length, 1.0, &["m", "metre", "metres", "meters"]),
        (D::Length, 1e-3, &["mm"]),
        (D::Length, 1e-6, &["um"]),
        (D::Length, 1e-2, &["cm"]),
        (D::Length, INCH, &["in", "inch", "inches"]),
        (D::Length, FOOT, &["ft", "foot", "feet"]),
        (D::Velocity, 1.0, &["m/s"]),
        (D::Velocity, 1e-3, &["mm/s"]),
        (D::Velocity, INCH, &["in/s", "inch/s", "ips"]),
        (D::Force, 1.0, &["N", "newton", "newtons"]),
        (D::Force, 1e-3, &["mN"]),
        (D::Force, 1e3, &["kN"]),
        (D::Force, LBF, &["lbf", "lb", "lbs"]),
        (D::Force, 1e3 * LBF, &["kip", "kips", "klbf"]),
        (D::Force, KGF, &["kgf"]),
        (D::Other, 1.0, &["V", "volt", "volts"]),
        (D::Other, 1e-3, &["mV"]),
        (D::Other, 1.0, &["W", "watt"]),
        (D::Other, 1.0, &["Pa"]),
        (D::Other, 1e5, &["bar"]),
        (D::Other, 1.0, &["Hz"]),
        (D::Other, 1e-2, &["%", "percent"]),
    ]
};

/// Normalizes spellings: µ and μ, dots and dashes for products, no spaces.
fn plain(text: &str) -> String {
    let text = text.trim().replace(['µ', 'μ'], "u").replace(['·', '⋅', '•', '×'], "*").replace("º", "°");
    let text: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    match text.as_str() {
        // A dash between two units is a product; a dash before a digit is an exponent.
        dashed if dashed.contains('-') && !dashed.ends_with("-1") => dashed.replace('-', "*"),
        dotted if dotted.len() > 2 && dotted.contains('.') => dotted.trim_end_matches('.').replace('.', "*"),
        _ => text,
    }
}

impl Unit {
    /// SI, for any quantity.
    pub const SI: Unit = Unit { dimension: Dimension::Other, factor: 1.0, offset: 0.0 };

    /// Parses common spellings: `deg`, `rpm`, `N·cm`, `counts/4096` (counts with the counts per turn), `°F`.
    pub fn parse(text: &str) -> Option<Unit> {
        let text = plain(text);
        if let Some(unit) = counts(&text) {
            return Some(unit);
        }
        // mA and MA, Nm and nm differ: first an exact match, then a match that ignores case if it is unique.
        let exact = UNITS.iter().find(|(_, _, names)| names.contains(&text.as_str()));
        let lower = text.to_lowercase();
        let alike = || {
            let mut rows = UNITS.iter().filter(|(_, _, names)| names.iter().any(|name| name.to_lowercase() == lower));
            rows.next().filter(|_| rows.next().is_none())
        };
        let (dimension, factor, names) = exact.or_else(alike)?;
        let offset = match names[0] {
            "K" => -ICE_K,
            "°F" => -32.0 * factor,
            _ => 0.0,
        };
        Some(Unit { dimension: *dimension, factor: *factor, offset })
    }

    /// The usual spelling of a unit: mA for `ma`.
    pub fn written(text: &str) -> Option<String> {
        let unit = Unit::parse(text)?;
        let same = |(dimension, factor, _): &&(Dimension, f64, &[&str])| {
            *dimension == unit.dimension && *factor == unit.factor
        };
        let (_, _, names) = UNITS.iter().find(same).filter(|_| unit.offset == 0.0)?;
        Some(names[0].to_owned())
    }

    pub fn to_si(self, value: f64) -> f64 {
        value * self.factor + self.offset
    }

    /// A unit of a sliding axis, whose columns have the names of a rotating axis.
    pub fn is_linear(self) -> bool {
        matches!(self.dimension, Dimension::Length | Dimension::Velocity | Dimension::Force)
    }

    pub fn is_si(self) -> bool {
        self.factor == 1.0 && self.offset == 0.0
    }

    /// Names to choose from, for a column of this dimension.
    pub fn names_of(dimension: Dimension) -> Vec<&'static str> {
        UNITS.iter().filter(|(of, _, _)| *of == dimension).map(|(_, _, names)| names[0]).collect()
    }
}

/// Whether the word means encoder counts.
pub fn is_count(word: &str) -> bool {
    const WORDS: [&str; 12] =
        ["count", "counts", "cnt", "cnts", "cts", "tick", "ticks", "inc", "incs", "increments", "lsb", "steps"];
    WORDS.contains(&word.to_lowercase().as_str())
}

/// Words in a line of units that are not convertible units.
pub fn is_unit_word(word: &str) -> bool {
    const WORDS: [&str; 10] = ["", "-", "1", "none", "grad", "raw", "digit", "digits", "bit", "bool"];
    WORDS.contains(&word.to_lowercase().as_str()) || is_count(word)
}

/// `counts/4096`: 1/4096 of a turn; `counts/4096/s`: the same per second.
fn counts(text: &str) -> Option<Unit> {
    let rest = ["counts/", "count/", "cts/", "ticks/", "inc/"].iter().find_map(|word| text.strip_prefix(word))?;
    let (number, dimension) = match rest.strip_suffix("/s") {
        Some(number) => (number, Dimension::AngularVelocity),
        None => (rest, Dimension::Angle),
    };
    let per_turn: f64 = number.parse().ok().filter(|n: &f64| n.is_finite() && *n != 0.0)?;
    Some(Unit { dimension, factor: TAU / per_turn, offset: 0.0 })
}

/// The quantity of a column of the run table, from the suffix of its name. `None` if it has no unit.
pub fn dimension_of(column: &str) -> Option<Dimension> {
    use Dimension as D;
    Some(match jointbench_instrument::units::unit_of(column)? {
        "s" => D::Time,
        "rad" => D::Angle,
        "rad/s" => D::AngularVelocity,
        "Nm" => D::Torque,
        "A" => D::Current,
        "°C" => D::Temperature,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_known_by_the_words_that_people_write() {
        for (word, dimension, value, si) in [
            ("deg", Dimension::Angle, 180.0, TAU / 2.0),
            ("°", Dimension::Angle, 180.0, TAU / 2.0),
            ("RPM", Dimension::AngularVelocity, 60.0, TAU),
            ("1/min", Dimension::AngularVelocity, 60.0, TAU),
            ("mA", Dimension::Current, 250.0, 0.25),
            ("N·cm", Dimension::Torque, 100.0, 1.0),
            ("N.mm", Dimension::Torque, 1000.0, 1.0),
            ("oz-in", Dimension::Torque, 1.0, OZF_IN),
            ("ozf·in", Dimension::Torque, 1.0, OZF_IN),
            ("°F", Dimension::Temperature, 212.0, 100.0),
            ("K", Dimension::Temperature, 300.15, 27.0),
            ("counts/4096", Dimension::Angle, 1024.0, TAU / 4.0),
            ("µs", Dimension::Time, 5.0, 5e-6),
            ("Second", Dimension::Time, 5.0, 5.0),
            ("kip", Dimension::Force, 1.0, 1e3 * LBF),
            ("in", Dimension::Length, 100.0, 2.54),
        ] {
            let unit = Unit::parse(word).unwrap_or_else(|| panic!("{word}"));
            assert_eq!(unit.dimension, dimension, "{word}");
            assert!((unit.to_si(value) - si).abs() < 1e-9, "{word}: {}", unit.to_si(value));
        }
        for word in ["", "fast", "counts/0", "counts/x", "counts", "m/A"] {
            assert_eq!(Unit::parse(word), None, "{word}");
        }
        assert_eq!(dimension_of("motor_velocity_rad_s"), Some(Dimension::AngularVelocity));
        assert_eq!(dimension_of("segment"), None);
    }
}
