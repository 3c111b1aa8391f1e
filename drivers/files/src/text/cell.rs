//! One cell of a text: a number, empty, a truth value, or words.

/// Words for a missing value in files of other programs, in lower case.
const MISSING: [&[u8]; 14] =
    [b"", b"nan", b"na", b"n/a", b"n.a.", b"n.a", b"-", b"--", b"---", b"null", b"none", b"#n/a", b"-nan", b"<na>"];
/// Longer cells are not such a word.
const LONGEST_WORD: usize = 8;

/// The decimal sign: point or comma. The other sign may separate thousands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Decimal {
    #[default]
    Point,
    Comma,
}

impl Decimal {
    /// The name of the sign in an option.
    pub fn word(self) -> &'static str {
        match self {
            Decimal::Point => "point",
            Decimal::Comma => "comma",
        }
    }

    pub fn sign(self) -> u8 {
        match self {
            Decimal::Point => b'.',
            Decimal::Comma => b',',
        }
    }

    fn grouping(self) -> u8 {
        match self {
            Decimal::Point => b',',
            Decimal::Comma => b'.',
        }
    }
}

/// Certainty of the decimal sign of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Neither point nor comma, or only the decimal sign.
    Plain,
    /// The other sign can only separate thousands: 1.234.567 or 1.234,5.
    Grouped,
    /// The other sign could separate thousands or decimals: 1.220 in a table with decimal commas.
    Doubtful,
}

pub fn is_missing(cell: &[u8]) -> bool {
    let cell = cell.trim_ascii();
    cell.len() <= LONGEST_WORD && MISSING.contains(&cell.to_ascii_lowercase().as_slice())
}

pub fn truth(cell: &[u8]) -> Option<bool> {
    let cell = cell.trim_ascii();
    if cell.len() > LONGEST_WORD {
        return None;
    }
    match cell.to_ascii_lowercase().as_slice() {
        b"true" | b"on" | b"yes" => Some(true),
        b"false" | b"off" | b"no" => Some(false),
        _ => None,
    }
}

/// The nearest double to a plain decimal number; spaces around it are ignored.
pub fn plain(cell: &[u8]) -> Option<f64> {
    // The parser accepts words, too.
    let first = cell.iter().find(|byte| !byte.is_ascii_whitespace())?;
    if !(first.is_ascii_digit() || matches!(first, b'-' | b'+' | b'.')) {
        return None;
    }
    let value: f64 = fast_float2::parse(cell.trim_ascii()).ok()?;
    // "-inf" and "-nan" are words; 1e999 is a number beyond the range of a double.
    (value.is_finite() || cell.iter().any(u8::is_ascii_digit)).then_some(value)
}

/// A number in a table with a known decimal sign.
pub fn number(cell: &[u8], decimal: Decimal) -> Option<(f64, Shape)> {
    let cell = cell.trim_ascii();
    if let Some(usual) = usual(cell) {
        return number(&usual, decimal);
    }
    let has = |sign: u8| cell.contains(&sign);
    if decimal == Decimal::Point && !has(b',') {
        let value = plain(cell).or_else(|| blank_groups(cell, decimal))?;
        return Some((value, Shape::Plain));
    }
    if !has(decimal.grouping()) {
        let value = swapped(cell, decimal).or_else(|| blank_groups(cell, decimal))?;
        return Some((value, Shape::Plain));
    }
    let whole = cell.split(|byte| *byte == decimal.sign()).next().unwrap_or_default();
    let groups = groups(whole, decimal.grouping())?;
    let ungrouped: Vec<u8> = cell.iter().copied().filter(|byte| *byte != decimal.grouping()).collect();
    let value = swapped(&ungrouped, decimal)?;
    let is_certain = groups > 2 || has(decimal.sign());
    Some((value, if is_certain { Shape::Grouped } else { Shape::Doubtful }))
}

/// Converts Fortran notation (1.5D-3) or a typographic minus to the usual notation.
fn usual(cell: &[u8]) -> Option<Vec<u8>> {
    const MINUS: &[u8] = "−".as_bytes();
    let mut usual = match cell.strip_prefix(MINUS) {
        Some(rest) => [b"-", rest].concat(),
        None => cell.to_vec(),
    };
    let place = usual.iter().position(|byte| matches!(byte, b'D' | b'd'));
    if let Some(place) =
        place.filter(|place| *place > 0 && usual[place - 1].is_ascii_digit() | (usual[place - 1] == b'.'))
    {
        usual[place] = b'E';
    }
    (usual != cell && usual.first().is_some_and(|byte| byte.is_ascii_digit() || matches!(byte, b'-' | b'+' | b'.')))
        .then_some(usual)
}

/// A number with this decimal sign, without grouping.
fn swapped(cell: &[u8], decimal: Decimal) -> Option<f64> {
    match decimal {
        Decimal::Point => plain(cell),
        Decimal::Comma if cell.contains(&b'.') => None,
        Decimal::Comma => {
            let pointed: Vec<u8> = cell.iter().map(|byte| if *byte == b',' { b'.' } else { *byte }).collect();
            // A decimal comma needs a digit after it; a decimal point does not.
            (pointed.last() != Some(&b'.')).then(|| plain(&pointed))?
        }
    }
}

/// 1 234,5 and 1'234.5: spaces and apostrophes only separate thousands.
fn blank_groups(cell: &[u8], decimal: Decimal) -> Option<f64> {
    let text = std::str::from_utf8(cell).ok()?;
    let parting = text.chars().find(|c| matches!(c, ' ' | '\'' | '\u{a0}' | '\u{202f}' | '\u{2009}' | '’'))?;
    let marked = text.replace(parting, "_");
    let whole = marked.split(decimal.sign() as char).next()?;
    groups(whole.as_bytes(), b'_')?;
    swapped(marked.replace('_', "").as_bytes(), decimal)
}

/// Number of groups of three digits after a first group of one to three digits that does not start with 0.
fn groups(whole: &[u8], sign: u8) -> Option<usize> {
    let whole = whole.strip_prefix(b"-").or_else(|| whole.strip_prefix(b"+")).unwrap_or(whole);
    let mut parts = whole.split(|byte| *byte == sign);
    let first = parts.next()?;
    let is_first = (1..=3).contains(&first.len()) && first[0] != b'0' && first.iter().all(u8::is_ascii_digit);
    let mut count = 1;
    for part in parts {
        count += 1;
        if part.len() != 3 || !part.iter().all(u8::is_ascii_digit) {
            return None;
        }
    }
    (is_first && count > 1).then_some(count)
}

/// Whether this sign could separate thousands: groups of three digits after one to three digits without a leading 0.
pub fn could_be_grouped(cell: &[u8], sign: u8) -> bool {
    groups(cell.trim_ascii(), sign).is_some()
}

/// The decimal sign of the table, if this number determines it.
pub fn decimal_sign(cell: &[u8]) -> Option<Decimal> {
    let cell = cell.trim_ascii();
    let place = |sign: u8| cell.iter().rposition(|byte| *byte == sign);
    let sure = |decimal: Decimal| number(cell, decimal).is_some_and(|(_, shape)| shape != Shape::Doubtful);
    match (place(b'.'), place(b',')) {
        (None, None) => None,
        (Some(_), None) => (!could_be_grouped(cell, b'.') && sure(Decimal::Point)).then_some(Decimal::Point),
        (None, Some(_)) => (!could_be_grouped(cell, b',') && sure(Decimal::Comma)).then_some(Decimal::Comma),
        (Some(point), Some(comma)) => {
            let decimal = if point > comma { Decimal::Point } else { Decimal::Comma };
            sure(decimal).then_some(decimal)
        }
    }
}

/// Whether the cell is a number with either decimal sign.
pub fn is_number(cell: &[u8]) -> bool {
    number(cell, Decimal::Point).is_some() || number(cell, Decimal::Comma).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_by_the_decimal_sign_of_their_table() {
        for (cell, decimal, value, shape) in [
            ("1.5", Decimal::Point, 1.5, Shape::Plain),
            (" -2e-3 ", Decimal::Point, -2e-3, Shape::Plain),
            ("1,234", Decimal::Point, 1234.0, Shape::Doubtful),
            ("1,234.5", Decimal::Point, 1234.5, Shape::Grouped),
            ("1,234,567", Decimal::Point, 1_234_567.0, Shape::Grouped),
            ("1,5", Decimal::Comma, 1.5, Shape::Plain),
            ("-0,25", Decimal::Comma, -0.25, Shape::Plain),
            ("1.220", Decimal::Comma, 1220.0, Shape::Doubtful),
            ("1.234,5", Decimal::Comma, 1234.5, Shape::Grouped),
            ("1 234,5", Decimal::Comma, 1234.5, Shape::Plain),
            ("1'234.5", Decimal::Point, 1234.5, Shape::Plain),
            ("5e-3", Decimal::Comma, 5e-3, Shape::Plain),
            ("1,5E+2", Decimal::Comma, 150.0, Shape::Plain),
        ] {
            assert_eq!(number(cell.as_bytes(), decimal), Some((value, shape)), "{cell} {decimal:?}");
        }
        for (cell, decimal) in [
            ("1.5", Decimal::Comma),
            ("0.220", Decimal::Comma),
            ("1,5", Decimal::Point),
            ("1,2345", Decimal::Point),
            ("12,", Decimal::Comma),
            ("fast", Decimal::Point),
            ("inf", Decimal::Point),
            ("2026-01-02", Decimal::Point),
            ("", Decimal::Point),
        ] {
            assert_eq!(number(cell.as_bytes(), decimal), None, "{cell} {decimal:?}");
        }
    }

    #[test]
    fn a_number_tells_its_decimal_sign_only_where_it_can() {
        for (cell, expected) in [
            ("1.5", Some(Decimal::Point)),
            ("0.005", Some(Decimal::Point)),
            ("1.234.5", None),
            ("1.220", None),
            ("1,5", Some(Decimal::Comma)),
            ("0,005", Some(Decimal::Comma)),
            ("1,220", None),
            ("1.234,5", Some(Decimal::Comma)),
            ("1,234.5", Some(Decimal::Point)),
            ("12", None),
            ("2.5e3", Some(Decimal::Point)),
        ] {
            assert_eq!(decimal_sign(cell.as_bytes()), expected, "{cell}");
        }
    }

    #[test]
    fn words_for_nothing_and_for_yes_and_no_are_known() {
        assert!(["", " ", "NaN", "n.a.", "-", "NULL", "#N/A"].iter().all(|cell| is_missing(cell.as_bytes())));
        assert!(!is_missing(b"0") && !is_missing(b"-1") && !is_missing(b"nominal"));
        assert_eq!((truth(b"True"), truth(b"FALSE"), truth(b"1")), (Some(true), Some(false), None));
    }
}
