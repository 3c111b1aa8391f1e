//! Times that are not plain numbers: dates with a time of day, and clock times.

use jiff::Timestamp;
use jiff::civil::DateTime;
use jiff::tz::TimeZone;

/// Nanoseconds since 1970 in UTC, or since midnight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stamp {
    Date(i64),
    Clock(i64),
}

impl Stamp {
    pub fn nanoseconds(self) -> i64 {
        match self {
            Stamp::Date(ns) | Stamp::Clock(ns) => ns,
        }
    }
}

const NS: i64 = 1_000_000_000;
/// `0:00:00` to `2026-01-02T10:00:00.000000000+01:00[Europe/Berlin]`.
const SHORTEST: usize = 5;
const LONGEST: usize = 64;

/// ISO 8601 with and without a zone, the dates of spreadsheets (02.01.2026, 01/02/2026, 2026/01/02) with a time of day,
/// and clock times (10:00:00.005, 00:05.2).
///
/// A date without a zone is taken as UTC, because only the time since the first row is used.
pub fn parse(cell: &[u8]) -> Option<Stamp> {
    let cell = cell.trim_ascii();
    if !(SHORTEST..=LONGEST).contains(&cell.len()) || !cell.contains(&b':') {
        return None;
    }
    let text = std::str::from_utf8(cell).ok()?;
    if !text.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    if let Some((days, rest)) = text.split_once(" days ").or_else(|| text.split_once(" day ")) {
        // A duration, as data frames write it.
        let days: i64 = days.parse().ok().filter(|days| (0..36_500).contains(days))?;
        return Some(Stamp::Clock(days * 86_400 * NS + clock(rest.trim())?));
    }
    match text.find(['T', ' ']) {
        Some(at) if text[..at].contains(['-', '/', '.']) => date(text, at).map(Stamp::Date),
        _ => clock(text).map(Stamp::Clock),
    }
}

fn date(text: &str, at: usize) -> Option<i64> {
    let ns = |timestamp: Timestamp| i64::try_from(timestamp.as_nanosecond()).ok();
    if let Ok(zoned) = text.parse::<Timestamp>() {
        return ns(zoned);
    }
    let utc = |time: DateTime| TimeZone::UTC.to_timestamp(time).ok().and_then(ns);
    if let Ok(time) = text.parse::<DateTime>() {
        return utc(time);
    }
    let sign = text[..at].find(['-', '/', '.']).map(|place| text.as_bytes()[place] as char)?;
    let mut parts = text[..at].split(sign).map(|part| part.trim().parse::<u16>().ok().or_else(|| month(part.trim())));
    let (a, b, c) = (parts.next()??, parts.next()??, parts.next()??);
    let (year, month, day) = match (a > 31, sign) {
        (true, _) => (a, b, c),
        // The month comes first only with slashes, and only if it can be a month.
        (false, '/') if a <= 12 => (c, a, b),
        (false, _) => (c, b, a),
    };
    let year = if year < 100 { year + 2000 } else { year };
    let day_ns = utc(format!("{year:04}-{month:02}-{day:02}T00:00:00").parse().ok()?)?;
    day_ns.checked_add(clock(text[at + 1..].trim())?)
}

/// `Mar` of 12-Mar-2026, as MATLAB writes it.
fn month(name: &str) -> Option<u16> {
    const MONTHS: [&str; 12] = ["jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"];
    MONTHS.iter().position(|month| name.eq_ignore_ascii_case(month)).map(|place| place as u16 + 1)
}

/// A century; a clock time beyond it is invalid.
const MOST_HOURS: u32 = 876_600;

/// hh:mm:ss.fff, mm:ss.fff, hh:mm:ss:mmm, each also with a comma and with AM or PM.
fn clock(text: &str) -> Option<i64> {
    let (text, noon) = match text.to_ascii_uppercase() {
        upper if upper.ends_with("PM") => (text[..text.len() - 2].trim_end(), Some(12)),
        upper if upper.ends_with("AM") => (text[..text.len() - 2].trim_end(), Some(0)),
        _ => (text.strip_suffix('Z').unwrap_or(text), None),
    };
    let parts: Vec<&str> = text.split(':').collect();
    let whole = |text: &str| text.parse::<u32>().ok().filter(|number| *number <= MOST_HOURS).map(i64::from);
    let (hours, minutes, seconds) = match parts.as_slice() {
        [minutes, seconds] if seconds.contains(['.', ',']) => (0, whole(minutes)?, fraction(seconds)?),
        [hours, minutes] => (whole(hours)?, whole(minutes)?, 0),
        [hours, minutes, seconds] => (whole(hours)?, whole(minutes)?, fraction(seconds)?),
        [hours, minutes, seconds, ms] if ms.len() == 3 => {
            (whole(hours)?, whole(minutes)?, whole(seconds)? * NS + whole(ms)? * (NS / 1000))
        }
        _ => return None,
    };
    let hours = noon.map_or(hours, |noon| hours % 12 + noon);
    (minutes < 60 || parts.len() == 2).then_some((hours * 3600 + minutes * 60) * NS + seconds)
}

/// Seconds with up to nine decimals, in nanoseconds.
fn fraction(text: &str) -> Option<i64> {
    let (whole, part) = text.split_once(['.', ',']).unwrap_or((text, ""));
    let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if whole.is_empty() || whole.len() > 2 || !digits(whole) || !digits(part) {
        return None;
    }
    let part = &part[..part.len().min(9)];
    let ns: i64 = if part.is_empty() { 0 } else { part.parse().ok()? };
    let seconds: i64 = whole.parse().ok()?;
    (seconds < 61).then_some(seconds * NS + ns * 10_i64.pow(9 - part.len() as u32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_and_clocks_are_read() {
        let first = parse(b"2026-01-02T10:00:00Z").unwrap().nanoseconds();
        for text in [
            "2026-01-02 10:00:00",
            "2026-01-02T11:00:00+01:00",
            "2026-01-02T11:00:00+0100",
            "02.01.2026 10:00:00",
            "2.1.2026 10:00",
            "2026/01/02 10:00:00",
            "1/2/2026 10:00:00 AM",
            "01/02/26 10:00:00",
            "02-Jan-2026 10:00:00.000",
        ] {
            assert_eq!(parse(text.as_bytes()), Some(Stamp::Date(first)), "{text}");
        }
        for (text, ms) in [
            ("2026-01-02T10:00:00.005Z", 5),
            ("2026-01-02 10:00:00,005", 5),
            ("02.01.2026 10:00:00,250", 250),
            ("1/2/2026 10:00:00.25 AM", 250),
        ] {
            assert_eq!(parse(text.as_bytes()), Some(Stamp::Date(first + ms * 1_000_000)), "{text}");
        }
        for (text, ms) in [
            ("00:00:01.005", 1005),
            ("0:00:01,5", 1500),
            ("01:02.5", 62_500),
            ("10:00:00:250", 36_000_250),
            ("12:00:01 AM", 1000),
            ("1:00:00 PM", 46_800_000),
            ("0 days 00:00:00.005000", 5),
            ("1 days 00:00:01", 86_401_000),
        ] {
            assert_eq!(parse(text.as_bytes()), Some(Stamp::Clock(ms * 1_000_000)), "{text}");
        }
        for text in
            ["12", "10.5", "ratio 1:50", "1:2:3:4:5", "2026-13-02 10:00:00", "aa:bb:cc", "10:99:00", "4000000000:00"]
        {
            assert_eq!(parse(text.as_bytes()), None, "{text}");
        }
    }
}
