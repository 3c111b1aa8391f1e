//! Checks of single values: each is valid, or reported with a remedy.

use super::error::Collector;
use jiff::Zoned;
use jiff::civil::Date;
use jointbench_devices::PortSettings;
use std::ops::RangeInclusive;
use toml::Spanned;
use toml::value::Datetime;

const LONGEST_DEADLINE_MS: u64 = 10_000;
const DEADLINE_MS: u64 = 100;

/// `Some(None)` for an empty slot, `Some(Some)` for a valid value, `None` for an invalid one.
pub fn flip<T>(slot: Option<Option<T>>) -> Option<Option<T>> {
    match slot {
        None => Some(None),
        Some(checked) => checked.map(Some),
    }
}

pub fn port(given: &Spanned<String>, baud: u32, wrong: &mut Collector) -> Option<PortSettings> {
    let text = given.get_ref().trim();
    let cure = match text {
        "" => Some("port is empty: enter a serial port (/dev/ttyUSB0, COM3), usb://serial-number or tcp://host:port"),
        "usb://" => Some("port has no serial number: write usb:// with the serial number from `jointbench ports`"),
        _ if text.strip_prefix("tcp://").is_some_and(|host| !has_port(host)) => {
            Some("port has no host or port number: write tcp://host:port, such as tcp://192.168.0.7:5555")
        }
        _ => None,
    };
    if let Some(cure) = cure {
        wrong.add(given.span(), cure);
        return None;
    }
    Some(PortSettings::new(text, baud))
}

fn has_port(host: &str) -> bool {
    host.rsplit_once(':').is_some_and(|(name, number)| !name.is_empty() && number.parse::<u16>().is_ok())
}

pub fn deadline_ms(given: Option<&Spanned<u64>>, wrong: &mut Collector) -> Option<u64> {
    given.map_or(Some(DEADLINE_MS), |given| within(given, "deadline_ms", 1..=LONGEST_DEADLINE_MS, wrong))
}

pub fn within<T: Copy + PartialOrd + std::fmt::Display>(
    given: &Spanned<T>,
    what: &str,
    range: RangeInclusive<T>,
    wrong: &mut Collector,
) -> Option<T> {
    let value = *given.get_ref();
    if range.contains(&value) {
        return Some(value);
    }
    wrong.add(given.span(), format!("{what} {value}: choose {} to {}", range.start(), range.end()));
    None
}

pub fn choice<T: Copy>(given: &Spanned<String>, what: &str, known: &[(&str, T)], wrong: &mut Collector) -> Option<T> {
    let found = known.iter().find(|(name, _)| name == given.get_ref());
    if found.is_none() {
        let names: Vec<String> = known.iter().map(|(name, _)| format!("{name:?}")).collect();
        wrong.add(given.span(), format!("unknown {what} {:?}: write {}", given.get_ref(), names.join(" or ")));
    }
    found.map(|(_, value)| *value)
}

pub fn positive(given: &Spanned<f64>, what: &str, wrong: &mut Collector) -> Option<f64> {
    let value = *given.get_ref();
    if value.is_finite() && value > 0.0 {
        return Some(value);
    }
    wrong.add(given.span(), format!("{what} = {value}: expected a number above 0"));
    None
}

/// A date that is not in the future.
pub fn calibrated(given: &Spanned<Datetime>, wrong: &mut Collector) -> Option<Date> {
    let written = given.get_ref();
    let day = written.date.filter(|_| written.time.is_none()).and_then(|date| {
        let (year, month, day) =
            (i16::try_from(date.year).ok()?, date.month.try_into().ok()?, date.day.try_into().ok()?);
        Date::new(year, month, day).ok()
    });
    match day {
        None => wrong.add(given.span(), format!("calibrated = {written}: write a date, such as 2026-03-31")),
        Some(day) if day > Zoned::now().date() => {
            wrong.add(given.span(), format!("calibrated = {day} is in the future: write the date of the certificate"));
        }
        Some(_) => return day,
    }
    None
}
