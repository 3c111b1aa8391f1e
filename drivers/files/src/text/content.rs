//! Content and decimal sign of columns from their first rows.

use super::cell::{self, Decimal};
use super::line::{Holds, holds};
use super::stamp::{self, Stamp};

/// Content of a column, judged by its first rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Content {
    #[default]
    Numbers,
    /// Dates or times of day, read as seconds since the first one.
    Stamps(Stamp),
    Words,
    /// No content and no name, as after a separator at the end of each line.
    Empty,
}

/// Content of most cells of a column.
pub fn content<'c>(cells: impl Iterator<Item = &'c [u8]>) -> Content {
    let (mut numbers, mut words, mut stamps, mut first) = (0, 0, 0, None);
    let mut is_bare = true;
    for cell in cells {
        is_bare &= cell.is_empty();
        match holds(cell) {
            Holds::Number | Holds::Truth => numbers += 1,
            Holds::Words => words += 1,
            Holds::Nothing => {}
            Holds::Stamp => {
                stamps += 1;
                first = first.or_else(|| stamp::parse(cell));
            }
        }
    }
    match first {
        Some(stamp) if stamps > words.max(numbers) => Content::Stamps(stamp),
        _ if words > numbers => Content::Words,
        _ if is_bare => Content::Empty,
        _ => Content::Numbers,
    }
}

/// Decimal sign of most unambiguous numbers. A comma, if there are only commas and no number is unambiguous.
pub fn decimal_of<'c>(cells: impl Iterator<Item = &'c Vec<u8>>) -> Decimal {
    let (mut points, mut commas, mut doubtful_commas, mut doubtful_points) = (0, 0, 0, 0);
    for cell in cells {
        match cell::decimal_sign(cell) {
            Some(Decimal::Point) => points += 1,
            Some(Decimal::Comma) => commas += 1,
            None if cell::could_be_grouped(cell, b',') => doubtful_commas += 1,
            None if cell::could_be_grouped(cell, b'.') => doubtful_points += 1,
            None => {}
        }
    }
    match (points, commas) {
        (0, 0) if doubtful_commas > 0 && doubtful_points == 0 => Decimal::Comma,
        _ if commas > points => Decimal::Comma,
        _ => Decimal::Point,
    }
}
