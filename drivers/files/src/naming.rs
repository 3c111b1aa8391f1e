//! Names of columns in files: the quantity, and the unit in brackets, after a slash or in a line of units.

use crate::ProposedOption;
use crate::column::Column;
use crate::note::Note;
use crate::text::Content;
use crate::unit::{Dimension, Unit, dimension_of};
use jointbench_instrument::units::quantity_of;
use jointbench_instrument::{Kind, Meta, Motion};

/// A name without its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    /// In lower case, with underscores between words.
    pub quantity: String,
    /// As written in the file.
    pub unit: Option<String>,
}

impl Named {
    pub fn of(column: &Column) -> Named {
        let (quantity, unit) = parted(&column.name);
        Named { quantity: snake(quantity), unit: column.unit.clone().or_else(|| unit.map(str::to_owned)) }
    }
}

/// `Torque [mNm]`, `t/s`, `speed in rpm` and `angle, deg` into quantity and unit.
pub fn parted(name: &str) -> (&str, Option<&str>) {
    let name = name.trim();
    for (open, close) in [('[', ']'), ('(', ')'), ('<', '>'), ('{', '}')] {
        let inner = name.strip_suffix(close).and_then(|name| name.rsplit_once(open));
        if let Some((quantity, unit)) = inner.filter(|(quantity, _)| !quantity.trim().is_empty()) {
            return (quantity.trim(), Some(unit.trim()));
        }
    }
    for sign in [" in ", ", ", " / ", "/"] {
        // A unit such as rad/s contains a slash: the first slash separates quantity and unit.
        if let Some((quantity, unit)) = name.split_once(sign)
            && Unit::parse(unit).is_some()
            && !quantity.trim().is_empty()
        {
            return (quantity.trim(), Some(unit.trim()));
        }
    }
    (name, None)
}

/// `Motor Position` → `motor_position`; `iqMeasured` → `iq_measured`.
fn snake(name: &str) -> String {
    // mA and mNm are one word each.
    let unit = name.rsplit(|c: char| !c.is_alphanumeric()).next().filter(|word| Unit::parse(word).is_some());
    let (name, unit) = match unit {
        Some(unit) if unit.len() < name.len() => (&name[..name.len() - unit.len()], unit),
        _ => (name, ""),
    };
    let mut text = String::new();
    let mut was_lower = false;
    for c in name.chars() {
        if c.is_alphanumeric() {
            if c.is_uppercase() && was_lower {
                text.push('_');
            }
            was_lower = c.is_lowercase();
            text.extend(c.to_lowercase());
        } else {
            was_lower = false;
            if !text.ends_with('_') && !text.is_empty() {
                text.push('_');
            }
        }
    }
    text.push_str(&unit.to_lowercase());
    text.trim_end_matches('_').to_owned()
}

/// Names of the time.
const TIMES: [&str; 27] = [
    "time",
    "t",
    "times",
    "timestamp",
    "time_stamp",
    "timestamps",
    "datetime",
    "date_time",
    "date_and_time",
    "elapsed",
    "elapsed_time",
    "zeit",
    "temps",
    "tiempo",
    "tempo",
    "zeitstempel",
    "uhrzeit",
    "second",
    "seconds",
    "sec",
    "x_axis",
    "x_value",
    "index_time",
    "micros",
    "millis",
    "clock",
    "time_of_day",
];

/// Columns whose names are also used for other quantities.
const NAMELESS: [&str; 2] = ["velocity_rad_s", "position_rad"];

pub fn is_time(quantity: &str) -> bool {
    TIMES.contains(&quantity)
}

/// Whether a column with this name holds the time.
pub fn names_time(name: &str) -> bool {
    let quantity = snake(parted(name).0);
    is_time(&quantity) || quantity == "time_s"
}

/// Columns of the run table of a kind.
pub fn known(kind: Kind) -> impl Iterator<Item = &'static str> {
    kind.required_columns().iter().chain(kind.optional_columns()).copied()
}

/// A column of the run table with a different name in the file.
pub struct Match {
    pub place: usize,
    pub column: &'static str,
    /// Unit, if the file states it.
    pub unit: Option<(String, Unit)>,
}

/// Columns with the full name of a known quantity and a unit of its dimension. A time may have another name, and no
/// unit.
pub fn matches(columns: &[Column], kind: Option<Kind>, motion: Motion) -> Vec<Match> {
    let there = |name: &str| columns.iter().any(|column| column.name == name);
    let wanted: Vec<&'static str> = match kind {
        Some(kind) => known(kind).collect(),
        // Without a kind, a general name such as `position_rad` is ambiguous.
        None => Kind::ALL.into_iter().flat_map(known).filter(|name| !NAMELESS.contains(name)).collect(),
    };
    let mut found: Vec<Match> = Vec::new();
    for column in wanted.into_iter().filter(|column| !there(column)) {
        if found.iter().any(|one| one.column == column) {
            continue;
        }
        let candidate = columns.iter().enumerate().find_map(|(place, source)| {
            let is_taken = found.iter().any(|one| one.place == place);
            if is_taken { None } else { match_of(place, source, column, motion) }
        });
        found.extend(candidate);
    }
    found
}

fn match_of(place: usize, source: &Column, column: &'static str, motion: Motion) -> Option<Match> {
    let named = Named::of(source);
    let unit = named.unit.as_deref().and_then(|text| Some((text.to_owned(), Unit::parse(text)?)));
    let found = |unit| Some(Match { place, column, unit });
    if column == "time_s" {
        let (is_stamped, is_of_time) = (matches!(source.content, Content::Stamps(_)), is_time(&named.quantity));
        let fits = unit.as_ref().is_none_or(|(_, unit)| unit.dimension == Dimension::Time);
        return if is_of_time && (is_stamped || fits) || named.quantity == column { found(unit) } else { None };
    }
    let Some(dimension) = dimension_of(column) else {
        // Whole numbers without a unit: segment, repeat.
        return (named.quantity == column && named.unit.is_none()).then_some(Match { place, column, unit: None });
    };
    let fits = |of: Dimension| of == dimension || (motion == Motion::Linear && is_slid(dimension, of));
    match &unit {
        Some((_, of)) if fits(of.dimension) => {
            let is_same = named.quantity == column || Some(named.quantity.as_str()) == quantity_of(column);
            if is_same { found(unit) } else { None }
        }
        // The unit is in the name as the run table writes it.
        None if named.quantity == column && named.unit.is_none() => found(None),
        _ => None,
    }
}

fn is_slid(turning: Dimension, found: Dimension) -> bool {
    use Dimension as D;
    matches!((turning, found), (D::Angle, D::Length) | (D::AngularVelocity, D::Velocity) | (D::Torque, D::Force))
}

/// Another column of the file as the source.
fn other_source(column: &str) -> ProposedOption {
    ProposedOption::open("map", format!("{column}=NAME"))
}

/// Renames columns with such names and converts them to SI. The time keeps its unit until it is read.
pub fn apply(columns: &mut [Column], meta: &Meta, notes: &mut Vec<Note>) {
    for Match { place, column, unit } in matches(columns, meta.kind, meta.motion) {
        let source = &mut columns[place];
        let was = std::mem::replace(&mut source.name, column.to_owned());
        if column == "time_s" {
            source.is_unit_open = unit.is_none() && was.to_lowercase() != column;
            source.unit = unit.map(|(text, _)| text);
            if was != column {
                notes.push(Note::with(format!("“{column}” is “{was}”"), other_source(column)));
            }
            continue;
        }
        source.unit = None;
        match unit {
            Some((text, unit)) if !unit.is_si() => {
                source.values.iter_mut().for_each(|value| *value = unit.to_si(*value));
                notes.push(Note::with(
                    format!("“{column}” is “{was}”, converted from {text}"),
                    ProposedOption::open("map", format!("{column}={was}")).and("unit", format!("{column}=UNIT")),
                ));
            }
            _ => notes.push(Note::with(format!("“{column}” is “{was}”"), other_source(column))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantity_and_unit_are_parted() {
        for (name, quantity, unit) in [
            ("Motor Position [deg]", "motor_position", Some("deg")),
            ("t/s", "t", Some("s")),
            ("motor velocity (rad/s)", "motor_velocity", Some("rad/s")),
            ("omega/rad/s", "omega", Some("rad/s")),
            ("speed in rpm", "speed", Some("rpm")),
            ("angle, deg", "angle", Some("deg")),
            ("motorCurrent", "motor_current", None),
            ("Iq", "iq", None),
            ("motor_current_mA", "motor_current_ma", None),
            ("trq mNm", "trq_mnm", None),
            ("[deg]", "deg", None),
            ("on/off", "on_off", None),
        ] {
            let named = Named::of(&Column::new(name, Vec::new()));
            assert_eq!((named.quantity.as_str(), named.unit.as_deref()), (quantity, unit), "{name}");
        }
    }

    #[test]
    fn only_columns_with_a_full_name_are_taken() {
        let taken = |name: &str, kind| {
            let found = matches(&[Column::new(name, vec![1.0])], Some(kind), Motion::Rotary);
            found.first().map(|one| (one.column, one.unit.as_ref().map(|(_, unit)| unit.factor)))
        };
        assert_eq!(taken("Motor Current [mA]", Kind::Friction), Some(("motor_current_a", Some(1e-3))));
        assert_eq!(taken("Motor_Position_Rad", Kind::Friction), Some(("motor_position_rad", None)));
        assert_eq!(taken("Time", Kind::Friction), Some(("time_s", None)));
        assert_eq!(taken("Segment", Kind::Friction), Some(("segment", None)));
        assert_eq!(taken("Motor Position", Kind::Friction), None, "its unit is not known");
        assert_eq!(taken("Motor Position [V]", Kind::Friction), None);
        assert_eq!(taken("Current [A]", Kind::Friction), None, "of the motor or of the brake");
        assert_eq!(taken("time [V]", Kind::Friction), None);
    }
}
