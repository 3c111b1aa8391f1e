//! A run table: the samples of one run with the facts about the set-up, checked once when it is created.

use crate::skew::align;
use crate::zero::subtract;
use crate::{Kind, Meta, Trace};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// One run, ready for a model: it has the required columns, and its time is finite and rises.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunTable {
    kind: Kind,
    meta: Meta,
    trace: Trace,
}

/// Why a table is refused. Rows count from 0 after the header; the file readers convert them to line numbers.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TableFault {
    /// The facts do not state the kind.
    #[error(
        "unknown kind of run: expected \"kind\": friction, encoder, stiffness or brake in the facts (meta.json in the \
         folder of the table, or --meta FILE)"
    )]
    UnknownKind,
    /// A required column is absent.
    #[error(
        "column {column} is missing: a table of kind {kind} needs {}, and the file has {}; take it from another column with \
         --map {column}=NAME",
        .kind.required_columns().join(", "), .found.join(", ")
    )]
    MissingColumn {
        /// Kind of the table.
        kind: Kind,
        /// Name of the absent column.
        column: &'static str,
        /// Names of the columns of the table.
        found: Vec<String>,
    },
    /// A column has the quantity of a known column in another unit.
    #[error(
        "column {found}: the unit is not the expected one, expected {expected}; convert it with --map {expected}={found} \
         --unit {expected}={}",
        unit_words(.found, .expected)
    )]
    WrongUnit {
        /// Name of the column.
        found: String,
        /// Known name with its unit.
        expected: String,
    },
    /// The value of a fact is physically impossible.
    #[error("{fact} = {value} in the facts: expected {expected}")]
    ImpossibleFact {
        /// Name of the fact.
        fact: &'static str,
        /// Its value.
        value: f64,
        /// The possible values, in words.
        expected: &'static str,
    },
    /// Stated and measured sample rate differ by a factor of ten or more.
    #[error(
        "the facts say {stated_hz} samples in a second, column time_s says {found_hz:.3}: expected seconds; convert the time \
         with --scale time_s=FACTOR, or correct sample_rate_hz"
    )]
    TimeAgainstRate {
        /// Sample rate in the facts.
        stated_hz: f64,
        /// Sample rate from the median time step.
        found_hz: f64,
    },
    /// Two columns have this name.
    #[error("column {0} occurs twice")]
    DuplicateColumn(String),
    /// A value is infinite or not a number.
    #[error("column {column}: expected a finite number, found {value}")]
    NotFinite {
        /// Name of the column.
        column: String,
        /// Row, counted from 0.
        row: usize,
        /// The value.
        value: f64,
    },
    /// Time does not increase from one row to the next.
    #[error("column time_s: expected a time after {before} s, found {after} s")]
    TimeNotRising {
        /// The later row, counted from 0.
        row: usize,
        /// Time of the earlier row (s).
        before: f64,
        /// Time of the later row (s).
        after: f64,
    },
    /// A segment or repeat number is not whole.
    #[error("column {column}: expected a whole number, found {value}")]
    NotWhole {
        /// Name of the column.
        column: String,
        /// Row, counted from 0.
        row: usize,
        /// The value.
        value: f64,
    },
    /// This column is in only one part of a measurement that continues another.
    #[error("column {0} is not in both parts of the measurement")]
    Different(String),
    /// The table has no rows.
    #[error("the table has no rows: expected at least one sample")]
    Empty,
}

impl TableFault {
    /// The row at fault, counted from 0 after the header, if the fault is in one row.
    pub fn row(&self) -> Option<usize> {
        match self {
            TableFault::NotFinite { row, .. }
            | TableFault::TimeNotRising { row, .. }
            | TableFault::NotWhole { row, .. } => Some(*row),
            _ => None,
        }
    }

    /// The column at fault, if the fault is in one column.
    pub fn column(&self) -> Option<&str> {
        match self {
            TableFault::MissingColumn { column, .. } => Some(column),
            TableFault::WrongUnit { found, .. } => Some(found),
            TableFault::DuplicateColumn(column) => Some(column),
            TableFault::NotFinite { column, .. } | TableFault::NotWhole { column, .. } => Some(column),
            TableFault::TimeNotRising { .. } | TableFault::TimeAgainstRate { .. } => Some("time_s"),
            TableFault::Different(_)
            | TableFault::UnknownKind
            | TableFault::Empty
            | TableFault::ImpossibleFact { .. } => None,
        }
    }
}

impl RunTable {
    /// Checks a trace against its kind: required columns, units, finite values, rising time, whole segment numbers.
    ///
    /// Unknown columns may contain any finite value. Columns with a skew are moved to the times of the rows
    /// ([`crate::skew`]), and the zero of a torque sensor is subtracted ([`crate::zero`]). Cost: one pass over the
    /// columns.
    pub fn new(mut meta: Meta, trace: Trace) -> Result<Self, TableFault> {
        let kind = meta.kind.ok_or(TableFault::UnknownKind)?;
        check_names(kind, &trace)?;
        if trace.is_empty() {
            return Err(TableFault::Empty);
        }
        for (channel, column) in trace.channels().iter().zip(trace.columns()) {
            if let Some(row) = column.iter().position(|v| !v.is_finite()) {
                return Err(TableFault::NotFinite { column: channel.name.clone(), row, value: column[row] });
            }
            if matches!(channel.name.as_str(), "segment" | "repeat")
                && let Some(row) = column.iter().position(|v| v.fract() != 0.0)
            {
                return Err(TableFault::NotWhole { column: channel.name.clone(), row, value: column[row] });
            }
        }
        let time_s = trace.column("time_s").unwrap_or_default();
        if let Some(row) = time_s.windows(2).position(|w| w[1] <= w[0]) {
            return Err(TableFault::TimeNotRising { row: row + 1, before: time_s[row], after: time_s[row + 1] });
        }
        check_facts(&meta, time_s)?;
        let trace = align(subtract(&mut meta, trace));
        Ok(Self { kind, meta, trace })
    }

    /// The kind of run.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// The facts about the set-up.
    pub fn meta(&self) -> &Meta {
        &self.meta
    }

    /// The samples.
    pub fn trace(&self) -> &Trace {
        &self.trace
    }

    /// Number of rows, at least 1.
    pub fn len(&self) -> usize {
        self.trace.len()
    }

    /// `false`: a run table has at least one row.
    pub fn is_empty(&self) -> bool {
        self.trace.is_empty()
    }

    /// The values of a column, one for each row. `None`: no such column.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.trace.column(name)
    }

    /// A copy without some rows. `excluded` are ranges of rows in rising order that do not overlap; at least one row
    /// remains.
    pub fn without(&self, excluded: &[Range<usize>]) -> Self {
        let keep = |column: &Vec<f64>| {
            let ends = excluded.iter().map(|range| range.start).chain([column.len()]);
            let starts = [0].into_iter().chain(excluded.iter().map(|range| range.end));
            starts.zip(ends).flat_map(|(start, end)| &column[start..end]).copied().collect()
        };
        let columns = self.trace.columns().iter().map(keep).collect();
        let trace = Trace::from_columns(self.trace.channels().to_vec(), columns);
        Self { kind: self.kind, meta: self.meta.clone(), trace }
    }

    /// Facts and samples, without a copy.
    pub fn into_parts(self) -> (Meta, Trace) {
        (self.meta, self.trace)
    }
}

fn check_names(kind: Kind, trace: &Trace) -> Result<(), TableFault> {
    let names: Vec<&str> = trace.channels().iter().map(|c| c.name.as_str()).collect();
    for (i, name) in names.iter().enumerate() {
        if names[..i].contains(name) {
            return Err(TableFault::DuplicateColumn((*name).to_owned()));
        }
    }
    // `motor_position_deg` instead of the known `motor_position_rad`: a unit to convert, not a column to ignore.
    let known = || kind.required_columns().iter().chain(kind.optional_columns());
    for name in names.iter().filter(|name| !known().any(|k| k == *name)) {
        let expected = known().find(|k| {
            let Some(unit) = crate::units::unit_of(k) else { return false };
            let quantity = &k[..k.len() - unit_suffix(k, unit)];
            name.strip_prefix(quantity).is_some_and(is_unit_suffix)
        });
        if let Some(expected) = expected {
            return Err(TableFault::WrongUnit { found: (*name).to_owned(), expected: (*expected).to_owned() });
        }
    }
    match kind.required_columns().iter().find(|required| !names.contains(required)) {
        Some(column) => {
            let found = names.iter().map(|name| (*name).to_owned()).collect();
            Err(TableFault::MissingColumn { kind, column, found })
        }
        None => Ok(()),
    }
}

/// A stated rate that differs from the time column by this factor is in another unit.
const OTHER_UNIT: f64 = 10.0;

/// Refuses impossible facts. A negative gear ratio is possible: the link rotates in the opposite direction.
fn check_facts(meta: &Meta, time_s: &[f64]) -> Result<(), TableFault> {
    let is_positive = |value: f64| value.is_finite() && value > 0.0;
    for (fact, value, is_possible, expected) in [
        ("torque_constant_nm_per_a", meta.torque_constant_nm_per_a, is_positive as fn(f64) -> bool, "a number above 0"),
        ("gear_ratio", meta.gear_ratio, |value| value.is_finite() && value != 0.0, "a number other than 0"),
        ("rotor_inertia_kg_m2", meta.rotor_inertia_kg_m2, |value| value.is_finite() && value >= 0.0, "0 or more"),
        ("bearing_stiffness_nm_per_rad", meta.bearing_stiffness_nm_per_rad, is_positive, "a number above 0"),
        ("sample_rate_hz", meta.sample_rate_hz, is_positive, "a number above 0"),
    ] {
        if let Some(value) = value
            && !is_possible(value)
        {
            return Err(TableFault::ImpossibleFact { fact, value, expected });
        }
    }
    // The median of the first thousand steps ignores a pause between recordings.
    let mut steps_s: Vec<f64> = time_s.windows(2).take(1000).map(|w| w[1] - w[0]).collect();
    steps_s.sort_by(f64::total_cmp);
    if let (Some(stated_hz), Some(step_s)) = (meta.sample_rate_hz, steps_s.get(steps_s.len() / 2)) {
        let found_hz = 1.0 / step_s;
        if found_hz > stated_hz * OTHER_UNIT || found_hz < stated_hz / OTHER_UNIT {
            return Err(TableFault::TimeAgainstRate { stated_hz, found_hz });
        }
    }
    Ok(())
}

/// Length of the unit suffix of a known column name, including its underscore.
fn unit_suffix(name: &str, unit: &str) -> usize {
    match unit {
        "rad/s" => "_rad_s".len(),
        "rad" => "_rad".len(),
        "Nm" => "_nm".len(),
        _ => name.len() - name.rfind('_').unwrap_or(name.len()),
    }
}

/// The unit of a name with the quantity of `expected`, in the notation of a command-line option.
fn unit_words(found: &str, expected: &str) -> String {
    let unit = crate::units::unit_of(expected).map_or(0, |unit| unit_suffix(expected, unit));
    let rest = found.get(expected.len() - unit..).unwrap_or_default().trim_start_matches('_');
    match rest {
        "" => "UNIT".to_owned(),
        "counts" => "counts/PER_TURN".to_owned(),
        _ => rest.replace("_s", "/s"),
    }
}

/// Suffixes that other tools use for the same quantities in other units.
fn is_unit_suffix(rest: &str) -> bool {
    const OTHERS: [&str; 26] = [
        "", "_deg", "_deg_s", "_degrees", "_turns", "_turns_s", "_rev", "_rev_s", "_rpm", "_counts", "_mrad", "_rad",
        "_rad_s", "_ms", "_us", "_ns", "_min", "_ma", "_mnm", "_ncm", "_kelvin", "_k", "_f", "_mm", "_m", "_n",
    ];
    OTHERS.contains(&rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Channel;

    fn table(names: &[&str], rows: &[&[f64]]) -> Result<RunTable, TableFault> {
        let mut trace = Trace::new(names.iter().map(|n| Channel::new(*n)).collect());
        rows.iter().for_each(|row| trace.push_row(row));
        RunTable::new(Meta { kind: Some(Kind::Friction), ..Meta::default() }, trace)
    }

    const NAMES: [&str; 3] = ["time_s", "motor_position_rad", "motor_current_a"];

    #[test]
    fn a_complete_table_is_taken() {
        let table =
            table(&[NAMES[0], NAMES[1], NAMES[2], "kp"], &[&[0.0, 0.0, 0.1, 5.0], &[0.1, 0.0, 0.1, 5.0]]).unwrap();
        assert_eq!(table.len(), 2);
        assert_eq!(table.column("kp"), Some(&[5.0, 5.0][..]));
    }

    #[test]
    fn rows_are_excluded() {
        let rows: Vec<[f64; 3]> = (0..8).map(|i| [f64::from(i), 10.0 + f64::from(i), 0.5]).collect();
        let rows: Vec<&[f64]> = rows.iter().map(|row| &row[..]).collect();
        let rest = table(&NAMES, &rows).unwrap().without(&[0..2, 5..6]);
        assert_eq!(rest.column("time_s"), Some(&[2.0, 3.0, 4.0, 6.0, 7.0][..]));
        assert_eq!(rest.column(NAMES[1]), Some(&[12.0, 13.0, 14.0, 16.0, 17.0][..]));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let missing = table(&["time_s", "motor_position_rad"], &[&[0.0, 0.0]]).unwrap_err();
        assert_eq!(missing.column(), Some("motor_current_a"));

        let unit = table(&["time_s", "motor_position_deg", "motor_current_a"], &[&[0.0, 0.0, 0.0]]).unwrap_err();
        assert_eq!(
            unit,
            TableFault::WrongUnit { found: "motor_position_deg".into(), expected: "motor_position_rad".into() }
        );

        let nan = table(&NAMES, &[&[0.0, 0.0, 0.0], &[0.1, f64::NAN, 0.0]]).unwrap_err();
        assert_eq!((nan.row(), nan.column()), (Some(1), Some("motor_position_rad")));

        let back = table(&NAMES, &[&[0.1, 0.0, 0.0], &[0.1, 0.0, 0.0]]).unwrap_err();
        assert_eq!((back.row(), back.column()), (Some(1), Some("time_s")));

        assert_eq!(table(&NAMES, &[]).unwrap_err(), TableFault::Empty);
    }

    #[test]
    fn facts_that_cannot_be_are_refused() {
        let with = |meta: Meta| {
            let mut trace = Trace::new(NAMES.iter().map(|n| Channel::new(*n)).collect());
            (0..4).for_each(|i| trace.push_row(&[f64::from(i), 0.0, 0.0]));
            RunTable::new(Meta { kind: Some(Kind::Friction), ..meta }, trace)
        };
        let fact = |fault: TableFault| match fault {
            TableFault::ImpossibleFact { fact, .. } => fact,
            other => panic!("{other}"),
        };
        let ratio = with(Meta { gear_ratio: Some(0.0), ..Meta::default() }).unwrap_err();
        assert_eq!(fact(ratio), "gear_ratio");
        let constant = with(Meta { torque_constant_nm_per_a: Some(-0.1), ..Meta::default() }).unwrap_err();
        assert_eq!(fact(constant), "torque_constant_nm_per_a");
        let rate = with(Meta { sample_rate_hz: Some(1000.0), ..Meta::default() }).unwrap_err();
        assert_eq!(rate, TableFault::TimeAgainstRate { stated_hz: 1000.0, found_hz: 1.0 });
        with(Meta { sample_rate_hz: Some(1.0), gear_ratio: Some(-50.0), ..Meta::default() }).unwrap();
    }

    #[test]
    fn a_segment_is_a_whole_number() {
        let fault = table(&[NAMES[0], NAMES[1], NAMES[2], "segment"], &[&[0.0, 0.0, 0.0, 0.5]]).unwrap_err();
        assert_eq!(fault.column(), Some("segment"));
    }
}
