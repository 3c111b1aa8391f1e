//! Conversion of a table with other names or units to a run table.

use crate::Bounds;
use crate::omitted_rows::parse_rows;
use crate::text::Decimal;
use crate::unit::Unit;
use jointbench_instrument::Meta;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::ops::RangeInclusive;
use std::path::PathBuf;

/// Options for the import of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadOptions {
    /// File with the facts. It has priority over `meta`, embedded facts and a file in the folder of the table.
    pub meta_path: Option<PathBuf>,
    /// Facts that are already known.
    pub meta: Option<Meta>,
    /// Columns to rename: (name in the run table, name in the file).
    pub map: Vec<(String, String)>,
    /// Factors: (name in the run table, factor). A value in the table is the file's value times the factor.
    pub scale: Vec<(String, f64)>,
    /// Columns of the file to omit, with any content.
    pub leave: Vec<String>,
    /// A row with an empty cell is omitted and becomes a gap in time. Their number is a fact of the run.
    pub leave_empty_rows: bool,
    /// Lines of a text or rows of a columnar file to omit, with any content, as messages count them. Their number is a fact
    /// of the run.
    pub omit_rows: Vec<RangeInclusive<u64>>,
    /// Codes for an empty cell: words such as `OVLD`, numbers such as `-9999`. `none`: no number is a code.
    pub missing: Vec<String>,
    /// Units of the file: (name in the run table, unit).
    pub unit: Vec<(String, Unit)>,
    /// Wrapped angles to make continuous: (name in the run table, period in its SI unit).
    pub unwrap: Vec<(String, f64)>,
    /// Names of the columns, for a table without a line of names.
    pub names: Vec<String>,
    /// The decimal sign of a column of the file, or of all other columns.
    pub decimal: Vec<(Option<String>, Decimal)>,
    pub time: TimeFrom,
    /// A file in which time restarts contains several recordings: they are joined as runs of one measurement.
    pub split_runs: bool,
    pub bounds: Bounds,
}

/// The source of the time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum TimeFrom {
    #[default]
    Column,
    /// From the row number and this rate [Hz], for a table without a time.
    Rate(f64),
    /// The same, instead of the time in the table.
    RateInstead(f64),
    /// From the column; rows with the same time stamp are spread evenly up to the next stamp.
    Spread,
    /// No time: each row is the mean of one steady operating point.
    OperatingPoints,
}

impl ReadOptions {
    /// Columns of the run table that an option names.
    pub(crate) fn asked(&self) -> Vec<&str> {
        let mapped = self.map.iter().map(|(name, _)| name);
        let scaled = self.scale.iter().map(|(name, _)| name).chain(self.unit.iter().map(|(name, _)| name));
        mapped.chain(scaled).chain(self.unwrap.iter().map(|(name, _)| name)).map(String::as_str).collect()
    }

    pub(crate) fn decimal_of_all(&self) -> Option<Decimal> {
        self.decimal.iter().find(|(column, _)| column.is_none()).map(|(_, decimal)| *decimal)
    }

    /// The decimal sign that the user stated for all columns or for this one.
    pub(crate) fn decimal_of(&self, name: &str) -> Option<Decimal> {
        let own = self.decimal.iter().find(|(column, _)| column.as_deref() == Some(name));
        own.map(|(_, decimal)| *decimal).or_else(|| self.decimal_of_all())
    }
}

/// Import options as users and programs write them: options of the command line, parts of a request.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Choices {
    /// `column=name in the file`.
    pub map: Vec<String>,
    /// `column=factor`.
    pub scale: Vec<String>,
    /// `column=unit`.
    pub unit: Vec<String>,
    /// `column` or `column=period`.
    pub unwrap: Vec<String>,
    /// Names in the file.
    pub leave: Vec<String>,
    pub leave_empty_rows: bool,
    /// Lines of a text or rows of a columnar file, such as `17`, `40-52` or `900-`.
    pub omit_rows: Vec<String>,
    /// Codes for an empty cell, such as `-9999`.
    pub missing: Vec<String>,
    /// Names, separated by commas.
    pub names: Option<String>,
    /// `point`, `comma` or `name in the file=comma`.
    pub decimal: Vec<String>,
    pub rate: Option<f64>,
    pub time_from_rate: Option<f64>,
    pub spread_time: bool,
    pub operating_points: bool,
    pub split_runs: bool,
}

impl Choices {
    /// Each choice as a part of a request: its name and its text.
    pub fn parts(&self) -> Vec<(&'static str, String)> {
        let mut parts = Vec::new();
        for (name, list) in [
            ("map", &self.map),
            ("scale", &self.scale),
            ("unit", &self.unit),
            ("unwrap", &self.unwrap),
            ("leave", &self.leave),
            ("omit_rows", &self.omit_rows),
            ("missing", &self.missing),
            ("decimal", &self.decimal),
        ] {
            parts.extend(list.iter().map(|text| (name, text.clone())));
        }
        for (name, number) in [("rate", self.rate), ("time_from_rate", self.time_from_rate)] {
            parts.extend(number.map(|number| (name, number.to_string())));
        }
        for (name, is_chosen) in [
            ("leave_empty_rows", self.leave_empty_rows),
            ("spread_time", self.spread_time),
            ("operating_points", self.operating_points),
            ("split_runs", self.split_runs),
        ] {
            parts.extend(is_chosen.then(|| (name, true.to_string())));
        }
        parts.extend(self.names.iter().map(|names| ("names", names.clone())));
        parts
    }

    /// Accepts a part of a request. `Ok(false)`: no choice has this name.
    pub fn take(&mut self, name: &str, text: String) -> Result<bool, OptionFault> {
        let number = |text: &str| text.trim().parse().map_err(|_| OptionFault::Rate(f64::NAN)).map(Some);
        match name {
            "map" => self.map.push(text),
            "scale" => self.scale.push(text),
            "unit" => self.unit.push(text),
            "unwrap" => self.unwrap.push(text),
            "leave" => self.leave.push(text),
            "omit_rows" => self.omit_rows.push(text),
            "missing" => self.missing.push(text),
            "decimal" => self.decimal.push(text),
            "rate" => self.rate = number(&text)?,
            "time_from_rate" => self.time_from_rate = number(&text)?,
            "leave_empty_rows" => self.leave_empty_rows = text == "true",
            "spread_time" => self.spread_time = text == "true",
            "operating_points" => self.operating_points = text == "true",
            "split_runs" => self.split_runs = text == "true",
            "names" => self.names = Some(text),
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Checked options, with the widest bounds and without facts.
    pub fn options(&self) -> Result<ReadOptions, OptionFault> {
        let each = |list: &[String]| list.to_vec();
        Ok(ReadOptions {
            map: self.map.iter().map(|pair| parse_map(pair)).collect::<Result<_, _>>()?,
            scale: self.scale.iter().map(|pair| parse_scale(pair)).collect::<Result<_, _>>()?,
            unit: self.unit.iter().map(|pair| parse_unit(pair)).collect::<Result<_, _>>()?,
            unwrap: self.unwrap.iter().map(|text| parse_unwrap(text)).collect::<Result<_, _>>()?,
            leave: each(&self.leave),
            leave_empty_rows: self.leave_empty_rows,
            omit_rows: self.omit_rows.iter().map(|text| parse_rows(text)).collect::<Result<Vec<_>, _>>()?.concat(),
            missing: each(&self.missing),
            names: self.names.iter().flat_map(|names| names.split(',')).map(|name| name.trim().to_owned()).collect(),
            decimal: self.decimal.iter().map(|text| parse_decimal(text)).collect::<Result<_, _>>()?,
            time: self.time()?,
            split_runs: self.split_runs,
            ..ReadOptions::default()
        })
    }

    fn time(&self) -> Result<TimeFrom, OptionFault> {
        if self.operating_points && self.split_runs {
            return Err(OptionFault::RunsOfPoints);
        }
        let rate = |rate: f64| if rate.is_finite() && rate > 0.0 { Ok(rate) } else { Err(OptionFault::Rate(rate)) };
        match (self.rate, self.time_from_rate, self.spread_time, self.operating_points) {
            (None, None, false, false) => Ok(TimeFrom::Column),
            (Some(hz), None, false, false) => Ok(TimeFrom::Rate(rate(hz)?)),
            (None, Some(hz), false, false) => Ok(TimeFrom::RateInstead(rate(hz)?)),
            (None, None, true, false) => Ok(TimeFrom::Spread),
            (None, None, false, true) => Ok(TimeFrom::OperatingPoints),
            _ => Err(OptionFault::TwoTimes),
        }
    }
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OptionFault {
    #[error(
        "“{0}”: expected COLUMN=UNIT, such as motor_position_rad=deg, motor_position_rad=counts/4096 or motor_velocity_rad_s=rpm"
    )]
    Unit(String),
    #[error("“{0}”: expected COLUMN, or COLUMN=PERIOD in its SI unit, such as motor_position_rad=6.2831853")]
    Unwrap(String),
    #[error("“{0}”: expected point or comma, for all columns or for one of the file, such as current_ma=comma")]
    Decimal(String),
    #[error("“{0}”: expected rows as messages count them, such as 17, 40-52 or 900- (to the end), with commas between")]
    Rows(String),
    #[error("{0} is no rate: expected a number of rows a second above 0")]
    Rate(f64),
    #[error("time comes from one place: choose one of --rate, --time-from-rate, --spread-time and --operating-points")]
    TwoTimes,
    #[error(
        "--split-runs needs a time, which a table of conditions has not: remove one of --split-runs and --operating-points"
    )]
    RunsOfPoints,
    #[error("“{0}”: expected NAME=COLUMN, such as motor_current_a=Iq")]
    Map(String),
    #[error("“{0}”: expected NAME=FACTOR with a finite factor other than 0, such as motor_position_rad=0.0174532925")]
    Scale(String),
}

/// `motor_current_a=Iq` → (`motor_current_a`, `Iq`).
pub fn parse_map(text: &str) -> Result<(String, String), OptionFault> {
    match text.split_once('=') {
        Some((name, column)) if !name.trim().is_empty() && !column.trim().is_empty() => {
            Ok((name.trim().to_owned(), column.trim().to_owned()))
        }
        _ => Err(OptionFault::Map(text.to_owned())),
    }
}

/// `motor_position_rad=0.0174532925` → (`motor_position_rad`, 0.0174532925).
pub fn parse_scale(text: &str) -> Result<(String, f64), OptionFault> {
    let fault = || OptionFault::Scale(text.to_owned());
    let (name, factor) = text.split_once('=').ok_or_else(fault)?;
    let factor: f64 = factor.trim().parse().map_err(|_| fault())?;
    if name.trim().is_empty() || !factor.is_finite() || factor == 0.0 {
        return Err(fault());
    }
    Ok((name.trim().to_owned(), factor))
}

/// `motor_position_rad=deg` → (`motor_position_rad`, a degree).
fn parse_unit(text: &str) -> Result<(String, Unit), OptionFault> {
    let fault = || OptionFault::Unit(text.to_owned());
    let (name, unit) = text.split_once('=').ok_or_else(fault)?;
    let unit = Unit::parse(unit).filter(|_| !name.trim().is_empty()).ok_or_else(fault)?;
    let fits = crate::unit::dimension_of(name.trim()).is_none_or(|of| of == unit.dimension || unit.is_linear());
    if fits { Ok((name.trim().to_owned(), unit)) } else { Err(fault()) }
}

fn parse_unwrap(text: &str) -> Result<(String, f64), OptionFault> {
    let fault = || OptionFault::Unwrap(text.to_owned());
    let (name, period) = match text.split_once('=') {
        Some((name, period)) => (name, period.trim().parse().map_err(|_| fault())?),
        None => (text, TAU),
    };
    let is_period = |period: f64| period.is_finite() && period > 0.0;
    if is_period(period) && !name.trim().is_empty() { Ok((name.trim().to_owned(), period)) } else { Err(fault()) }
}

fn parse_decimal(text: &str) -> Result<(Option<String>, Decimal), OptionFault> {
    let (column, word) = match text.rsplit_once('=') {
        Some((column, word)) => (Some(column.trim().to_owned()), word),
        None => (None, text),
    };
    match word.trim() {
        "point" => Ok((column, Decimal::Point)),
        "comma" => Ok((column, Decimal::Comma)),
        _ => Err(OptionFault::Decimal(text.to_owned())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_checked_where_they_are_written() {
        assert_eq!(parse_map("motor_current_a=Iq"), Ok(("motor_current_a".into(), "Iq".into())));
        assert_eq!(parse_scale("x_rad = -2e-3"), Ok(("x_rad".into(), -2e-3)));
        for text in ["Iq", "=Iq", "x="] {
            assert!(parse_map(text).unwrap_err().to_string().contains("expected NAME=COLUMN"), "{text}");
        }
        for text in ["x_rad", "x_rad=deg", "x_rad=0", "x_rad=inf", "=2"] {
            assert!(parse_scale(text).unwrap_err().to_string().contains("expected NAME=FACTOR"), "{text}");
        }
    }

    #[test]
    fn choices_are_checked_where_they_are_written() {
        let all = Choices {
            unit: vec!["motor_position_rad=deg".into()],
            unwrap: vec!["motor_position_rad".into(), "x=1".into()],
            decimal: vec!["comma".into(), "a=b=point".into()],
            names: Some("time_s, x".into()),
            time_from_rate: Some(200.0),
            ..Choices::default()
        };
        let options = all.options().unwrap();
        assert_eq!(options.unwrap, [("motor_position_rad".to_owned(), TAU), ("x".to_owned(), 1.0)]);
        assert_eq!((options.decimal_of("a=b"), options.decimal_of("c")), (Some(Decimal::Point), Some(Decimal::Comma)));
        assert_eq!(
            (options.names, options.time),
            (vec!["time_s".to_owned(), "x".into()], TimeFrom::RateInstead(200.0))
        );
        let message = |choices: Choices| choices.options().unwrap_err().to_string();
        let unit = |text: &str| message(Choices { unit: vec![text.into()], ..Choices::default() });
        assert!(unit("motor_position_rad=rpm").contains("expected COLUMN=UNIT"), "of another dimension");
        assert!(unit("motor_position_rad").contains("expected COLUMN=UNIT"));
        assert!(message(Choices { rate: Some(-1.0), ..Choices::default() }).contains("-1 is no rate"));
        assert!(message(Choices { spread_time: true, rate: Some(1.0), ..Choices::default() }).contains("choose one"));
        assert!(
            message(Choices { operating_points: true, split_runs: true, ..Choices::default() })
                .contains("--split-runs")
        );
        assert!(message(Choices { decimal: vec!["dot".into()], ..Choices::default() }).contains("point or comma"));
    }
}
