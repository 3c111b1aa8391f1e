//! The time of a table: from its column in any unit and clock, or from a rate.

use crate::ProposedOption;
use crate::column::Column;
use crate::contradiction;
use crate::error::{FileError, FileFault};
use crate::guess::Proposal;
use crate::note::{Note, counted, plural};
use crate::operating_points;
use crate::options::{ReadOptions, TimeFrom};
use crate::order::{self, Order};
use crate::raw::RawTable;
use crate::text::{Content, Stamp};
use crate::unit::{DAY_S, Unit};
use jointbench_instrument::{Meta, TableFault};

const TIME: &str = "time_s";

/// Gives the table a rising time in seconds. Returns the first rows of all recordings except the first one.
pub(crate) fn settle(
    table: &mut RawTable,
    meta: &mut Meta,
    options: &ReadOptions,
    guessed: &[Proposal],
    file: &str,
) -> Result<Vec<usize>, FileError> {
    let in_file = |fault: FileFault| fault.in_file(file);
    if options.time == TimeFrom::OperatingPoints {
        operating_points::settle(table, meta, guessed).map_err(in_file)?;
        return Ok(Vec::new());
    }
    let stamped = table.place(TIME).map(|place| to_seconds(&mut table.columns[place], meta)).transpose();
    if let Some(note) = stamped.map_err(|fault| fault.at_line(file, table.names_line).in_column(TIME))?.flatten() {
        table.notes.push(note);
    }
    let period = options.unwrap.iter().find(|(name, _)| name == TIME).map(|(_, period)| *period);
    if let Some(place) = table.place(TIME) {
        let values = &mut table.columns[place].values;
        match period {
            Some(period) => contradiction::unwrap(values, period),
            None if options.time == TimeFrom::Column => refuse_overflow(table, place, file)?,
            None => {}
        }
    }
    let order = table.place(TIME).map(|place| Order::of(&table.columns[place].values));
    let starts = order.as_ref().map_or_else(Vec::new, |order| starts(order, &table.named_again));
    let (has_time, rate) = (order.is_some(), meta.sample_rate_hz.filter(|hz| *hz > 0.0));
    match (options.time, order, rate) {
        (TimeFrom::RateInstead(hz), _, _) => from_rate(table, hz, "--time-from-rate"),
        (TimeFrom::Rate(hz), None, _) => from_rate(table, hz, "--rate"),
        (TimeFrom::Rate(hz), Some(_), _) => {
            let message = "the table has a time of its own".to_owned();
            return Err(in_file(FileFault::Choice { message, options: vec![time_from_rate(hz)] }));
        }
        (TimeFrom::Column, None, Some(hz)) => from_rate(table, hz, "sample_rate_hz of the meta file"),
        (TimeFrom::Column | TimeFrom::Spread, None, _) => return Ok(Vec::new()),
        (TimeFrom::Spread, Some(order), _) => spread(table, &order),
        (TimeFrom::Column, Some(_), _) | (TimeFrom::OperatingPoints, ..) => {}
    }
    if has_time && options.time == TimeFrom::Column && !starts.is_empty() && !options.split_runs {
        return Err(several(table, &starts, file));
    }
    let values = &table.columns[table.place(TIME).unwrap_or_default()].values;
    let split: &[usize] = if options.split_runs { &starts } else { &[] };
    if let Some(error) = out_of_order(table, values, split, file) {
        return Err(error);
    }
    let noticed = order::noticed(values, split);
    table.notes.extend(noticed);
    Ok(split.to_vec())
}

/// Rows at which the time restarts, including those after a repeated line of names.
fn starts(order: &Order, named_again: &[usize]) -> Vec<usize> {
    let mut all = order.restarts.clone();
    all.extend(named_again.iter().filter(|row| **row > 0 && order.back.contains(row)));
    all.sort_unstable();
    all.dedup();
    all
}

/// Converts the column to seconds and returns a note about the conversion.
fn to_seconds(column: &mut Column, meta: &Meta) -> Result<Option<Note>, FileFault> {
    let values = &mut column.values;
    if let Content::Stamps(first) = column.content {
        if let Stamp::Clock(_) = first {
            unroll_days(values);
        }
        return Ok(Some(Note::new(format!(
            "“{TIME}” counts the seconds from the stamp in the first row, {}",
            column.first.first().map_or("", String::as_str)
        ))));
    }
    let (unit, note) = match (&column.unit, column.is_unit_open) {
        (Some(text), _) => {
            let unit = Unit::parse(text).unwrap_or(Unit::SI);
            (unit, (!unit.is_si()).then(|| Note::with(format!("“{TIME}” was converted from {text}"), other_unit())))
        }
        // Seconds since 1970 are only valid as dates before 2100.
        (None, is_open) if is_open || values.first().is_some_and(|first| *first > EPOCH_S.end) => {
            let (name, why) = open_unit(values, meta.sample_rate_hz)?;
            let message = format!("“{TIME}” has no unit and was taken as {name}, {why}");
            (Unit::parse(name).unwrap_or(Unit::SI), Some(Note::with(message, other_unit())))
        }
        (None, _) => (Unit::SI, None),
    };
    // With a clock that counts from long ago, a double would lose digits of the seconds.
    let zero =
        values.first().copied().filter(|first| unit.factor * first.abs() > YEAR_S && note.is_some()).unwrap_or(0.0);
    if !unit.is_si() || zero != 0.0 {
        values.iter_mut().for_each(|value| *value = (*value - zero) * unit.factor);
    }
    Ok(note)
}

const YEAR_S: f64 = 365.0 * DAY_S;

/// Continues a clock time past midnight.
fn unroll_days(values: &mut [f64]) {
    let (mut days, mut before) = (0.0, f64::NEG_INFINITY);
    for value in values {
        if *value + days < before - DAY_S / 2.0 {
            days += DAY_S;
        }
        *value += days;
        before = *value;
    }
}

/// Steps between rows of loggers, in seconds.
const STEPS_S: std::ops::RangeInclusive<f64> = 1e-5..=0.1;
/// Seconds since 1970, from 2000 to 2100.
const EPOCH_S: std::ops::Range<f64> = 9.46e8..4.1e9;
/// Step of a Windows file time, and the seconds from 1601 to 1970.
const FILE_TIME_S: f64 = 1e-7;
const FILE_TIME_EPOCH_S: f64 = 11_644_473_600.0;
/// Days since 1900, from 1954 to 2119.
const SHEET_DAYS: std::ops::Range<f64> = 20_000.0..80_000.0;

/// The unit that the values of a time indicate, and the reason.
fn open_unit(values: &[f64], rate_hz: Option<f64>) -> Result<(&'static str, String), FileFault> {
    const UNITS: [(&str, f64); 5] = [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9), ("days", DAY_S)];
    let step = order::usual_step(values);
    let first = values.first().copied().unwrap_or(0.0);
    let at = |factor: f64| (1.0 / (step * factor) * 1e3).round() / 1e3;
    if let Some(rate) = rate_hz
        && let Some((name, _)) = UNITS.iter().find(|(_, factor)| (step * factor * rate - 1.0).abs() < 0.2)
    {
        return Ok((name, format!("as sample_rate_hz of the meta file is {rate}")));
    }
    let is_epoch =
        |(_, factor): &&(&str, f64)| EPOCH_S.contains(&(first * factor)) && (1e-6..60.0).contains(&(step * factor));
    if let Some((name, _)) = UNITS[..4].iter().find(is_epoch) {
        return Ok((name, "since 1970".to_owned()));
    }
    if EPOCH_S.contains(&(first * FILE_TIME_S - FILE_TIME_EPOCH_S)) {
        return Ok(("100ns", "since 1601, as Windows counts it".to_owned()));
    }
    if SHEET_DAYS.contains(&first) && step < 1e-3 {
        return Ok(("days", "as spreadsheets count them".to_owned()));
    }
    if STEPS_S.contains(&step) {
        return Ok(("s", format!("which makes {} rows a second", at(1.0))));
    }
    let likely =
        UNITS[..4].iter().filter(|(name, factor)| *name == "s" && step < 60.0 || STEPS_S.contains(&(step * factor)));
    let mut likely: Vec<&(&str, f64)> = likely.collect();
    likely.sort_by_key(|(_, factor)| !STEPS_S.contains(&(step * factor)));
    let makes = |(name, factor): &&(&str, f64)| format!("{} with {name}", at(*factor));
    let message = format!(
        "the time has no unit, and its rows are {} apart: rows a second would be {}",
        rounded(step),
        likely.iter().map(makes).collect::<Vec<String>>().join(", ")
    );
    Err(FileFault::Choice {
        message,
        options: likely.iter().map(|(name, _)| ProposedOption::new("unit", format!("{TIME}={name}"))).collect(),
    })
}

/// The time by the row number and this rate, instead of the time in the table.
fn time_from_rate(hz: f64) -> ProposedOption {
    ProposedOption::new("time_from_rate", hz.to_string())
}

/// Another unit of the time, which the user knows.
fn other_unit() -> ProposedOption {
    ProposedOption::open("unit", format!("{TIME}=UNIT"))
}

/// Rounds to four decimals, or to four digits if the value is smaller than that. Prints without trailing zeros.
fn rounded(value: f64) -> f64 {
    let scale = 10_f64.powf((3.0 - value.abs().log10().floor()).clamp(4.0, 12.0));
    (value * scale).round() / scale
}

fn from_rate(table: &mut RawTable, hz: f64, whence: &str) {
    let values: Vec<f64> = (0..table.rows).map(|row| row as f64 / hz).collect();
    match table.place(TIME) {
        Some(place) => table.columns[place] = Column::new(TIME, values),
        None => table.columns.insert(0, Column::new(TIME, values)),
    }
    table.notes.push(Note::new(format!("“{TIME}” counts the rows, {hz} a second, by {whence}")));
}

/// A 32-bit counter wraps after this many ticks.
const OVERFLOW: f64 = 4_294_967_296.0;
/// Size of a wrap, including the step of the overflow, as a fraction of the counter range.
const LOST: std::ops::RangeInclusive<f64> = 0.99..=1.0;

/// Refuses a time that falls by the range of a counter of ms, µs or ns.
fn refuse_overflow(table: &RawTable, place: usize, file: &str) -> Result<(), FileError> {
    let values = &table.columns[place].values;
    let back: Vec<usize> = (1..values.len()).filter(|row| values[*row] < values[row - 1]).collect();
    let is_of = |period: &f64| back.iter().all(|row| LOST.contains(&((values[row - 1] - values[*row]) / period)));
    let period = [1e-3, 1e-6, 1e-9].map(|tick_s| tick_s * OVERFLOW).into_iter().find(is_of);
    let (Some(period), Some(row)) = (period, back.first()) else { return Ok(()) };
    let message = "the time restarts, as a 32-bit counter does when it overflows".to_owned();
    let fault = FileFault::Choice { message, options: vec![ProposedOption::new("unwrap", format!("{TIME}={period}"))] };
    Err(FileError { place: Box::new(table.located(file, *row)), fault }.in_column(TIME))
}

/// Spreads rows with the same stamp evenly up to the next stamp.
fn spread(table: &mut RawTable, order: &Order) {
    let Some(place) = table.place(TIME) else { return };
    order::spread(&mut table.columns[place].values);
    let message = format!(
        "{} of {} repeat a time stamp and were spread up to the next",
        counted(order.repeats),
        plural(table.rows, "row")
    );
    table.notes.push(Note::with(message, ProposedOption::flag("spread_time")));
}

fn several(table: &RawTable, starts: &[usize], file: &str) -> FileError {
    let count = starts.len() + 1;
    let message = format!("the time begins again: the file holds {count} recordings");
    let place = table.located(file, starts[0]);
    let options = vec![ProposedOption::flag("split_runs")];
    FileError { place: Box::new(place), fault: FileFault::Choice { message, options } }.in_column(TIME)
}

/// The first row that is not later than the row before, the probable cause, and the remedy.
fn out_of_order(table: &RawTable, values: &[f64], starts: &[usize], file: &str) -> Option<FileError> {
    let is_start = |row: &usize| starts.binary_search(row).is_ok();
    let row = (1..values.len()).find(|row| values[*row] <= values[row - 1] && !is_start(row))?;
    let fault = TableFault::TimeNotRising { row, before: values[row - 1], after: values[row] };
    let order = Order::of(values);
    let rate = order::rate_hz(values, starts);
    let (message, options) = match order.back.iter().filter(|row| !is_start(row)).count() {
        0 => {
            let (rows, repeats) = (plural(values.len(), "row"), counted(order.repeats));
            let verb = if order.repeats == 1 { "repeats" } else { "repeat" };
            let ticks = order.tick_s.map_or_else(String::new, |tick_s| {
                format!(
                    ": its clock ticks every {}, rows come every {}",
                    order::seconds(tick_s),
                    order::seconds(1.0 / rate)
                )
            });
            (
                format!("{repeats} of {rows} {verb} a time stamp{ticks}"),
                vec![time_from_rate(rate), ProposedOption::flag("spread_time")],
            )
        }
        back => {
            let verb = if back == 1 { "goes" } else { "go" };
            (format!("in {back} of {} the time {verb} back", plural(values.len(), "row")), vec![time_from_rate(rate)])
        }
    };
    let place = table.located(file, row);
    Some(FileError { place: Box::new(place), fault: FileFault::Time { fault, message, options } })
}
