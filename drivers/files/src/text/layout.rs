//! Layout of a text table from its first lines: separator, names, units and contents of the columns.
//!
//! A row is a line with numbers in the columns in which most lines have numbers. The names are in the last line of
//! words above the first row. A line of units may follow. Some loggers write a block of such lines, with a label in the
//! first cell of each line.

use super::cell::{self, Decimal};
use super::content::{Content, content, decimal_of};
use super::line::{Holds, Line, SEPARATORS, Separator, cells, holds, is_comment, lines, uncommented};
use crate::naming::names_time;
use crate::unit::{Unit, is_unit_word};
use std::collections::HashSet;

/// Number of lines that are read. The preface of a logger is shorter.
const LOOKED_AT: usize = 400;
/// Number of consecutive rows that marks the start of the rows.
const BEGINNING: usize = 3;

#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    pub separator: Separator,
    pub columns: Vec<Column>,
    /// `None` if the first line holds numbers.
    pub names_line: Option<u64>,
    pub units_line: Option<u64>,
    /// Number of lines above the names, without blank lines, and number of comments among them.
    pub above: usize,
    pub comments_above: usize,
    /// Byte offset and line number of the first row.
    pub start: usize,
    pub start_line: u64,
    pub decimal: Decimal,
    /// Names after the last column with content.
    pub extra_names: Vec<String>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// As written in the file; empty if the column has no name.
    pub name: String,
    /// As written in the line of units.
    pub unit: Option<String>,
    pub content: Content,
    /// First cells of the column.
    pub first: Vec<String>,
}

/// Number of first cells of a column.
const SHOWN: usize = 6;

impl Layout {
    /// `is_whole`: the head is the whole text. `decimal`: decimal sign, if the user states it.
    pub fn of(head: &[u8], is_whole: bool, decimal: Option<Decimal>) -> Layout {
        let all = lines(head, is_whole, LOOKED_AT);
        let (stated, all) = match all.split_first() {
            Some((first, rest)) if stated_separator(first.text).is_some() => (stated_separator(first.text), rest),
            _ => (None, all.as_slice()),
        };
        let filled: Vec<Line<'_>> = all.iter().filter(|line| !line.text.trim_ascii().is_empty()).copied().collect();
        let candidates: Vec<Separator> = stated.map_or_else(|| SEPARATORS.to_vec(), |one| vec![one]);
        let surveys = candidates.into_iter().map(|separator| Survey::of(&filled, separator));
        // The first one, if several have the same score.
        let best = surveys.reduce(|best, next| if next.score > best.score { next } else { best });
        let survey = best.unwrap_or_else(|| Survey::of(&filled, Separator::Sign(b',')));
        survey.layout(&filled, head.len(), decimal, usize::from(stated.is_some()))
    }

    /// Number of columns with a name or content.
    pub fn width(&self) -> usize {
        self.columns.iter().filter(|column| column.content != Content::Empty).count()
    }
}

/// Separator of a first line `sep=;`, as spreadsheets write it.
fn stated_separator(line: &[u8]) -> Option<Separator> {
    let line = line.trim_ascii();
    let line = line.strip_prefix(b"\"").and_then(|line| line.strip_suffix(b"\"")).unwrap_or(line);
    match line.strip_prefix(b"sep=").or_else(|| line.strip_prefix(b"SEP="))? {
        [sign] => Some(Separator::Sign(*sign)),
        b"\\t" | b"" => Some(Separator::Sign(b'\t')),
        _ => None,
    }
}

/// The first lines, split by one separator.
struct Survey {
    separator: Separator,
    rows: Vec<Vec<Vec<u8>>>,
    held: Vec<Vec<Holds>>,
    /// Number of cells of most lines with numbers.
    width: usize,
    /// Whether the first column holds the labels of a block of lines and is empty in the rows.
    has_empty_side: bool,
    score: f64,
}

impl Survey {
    fn of(lines: &[Line<'_>], separator: Separator) -> Survey {
        let rows: Vec<Vec<Vec<u8>>> = lines.iter().map(|line| cells(line.text, separator)).collect();
        let held: Vec<Vec<Holds>> = rows.iter().map(|row| row.iter().map(|cell| holds(cell)).collect()).collect();
        let mut worth: Vec<(usize, f64)> = Vec::new();
        // The lower half of the lines, because a preface differs from the rows.
        for held in held[held.len() / 2..].iter().filter(|held| held.len() > 1) {
            let filled = held.iter().filter(|one| **one != Holds::Nothing).count() as f64;
            let numbers = held.iter().filter(|one| matches!(one, Holds::Number | Holds::Stamp)).count() as f64;
            if numbers > 0.0 {
                let more = numbers * numbers / filled;
                match worth.iter_mut().find(|(width, _)| *width == held.len()) {
                    Some((_, sum)) => *sum += more,
                    None => worth.push((held.len(), more)),
                }
            }
        }
        let best = worth.into_iter().reduce(|best, next| if next.1 > best.1 { next } else { best });
        let (width, score) = best.unwrap_or_else(|| {
            // A text of words is scored by the cells of its first line, below any text with numbers.
            let width = rows.first().map_or(0, Vec::len);
            (width, if width > 1 { 1e-3 * width as f64 } else { 0.0 })
        });
        let has_empty_side = has_empty_side(&held, width);
        Survey { separator, rows, held, width, has_empty_side, score }
    }

    fn layout(&self, lines: &[Line<'_>], end: usize, decimal: Option<Decimal>, stated: usize) -> Layout {
        let begin = self.begin();
        let names = self.names(lines, begin);
        let units = names.as_ref().and_then(|names| names.units.as_ref()).map(|(at, _)| *at);
        let after = match &names {
            Some(names) if !names.heads_block => units.unwrap_or(names.at) + 1,
            _ => begin.min(lines.len()),
        };
        let (start, start_line) = match (lines.get(after), lines.last()) {
            (Some(line), _) => (line.start, line.number),
            (None, Some(last)) => (end, last.number + 1),
            (None, None) => (end, 1),
        };
        let first = names.as_ref().map_or(after, |names| names.at);
        let rows = || self.rows[after.min(self.rows.len())..].iter().filter(|row| row.len() > 1);
        let decimal = decimal.unwrap_or_else(|| decimal_of(rows().flatten()));
        let (columns, extra_names) = self.columns(after, names.as_ref());
        Layout {
            separator: self.separator,
            columns,
            names_line: names.as_ref().map(|names| lines[names.at].number),
            units_line: units.map(|at| lines[at].number),
            above: first + stated,
            comments_above: lines[..first].iter().filter(|line| is_comment(line.text)).count(),
            start,
            start_line,
            decimal,
            extra_names,
        }
    }

    /// For each column, whether most rows hold a number or a time.
    fn usual(&self) -> Vec<bool> {
        let holds_data = |one: &Holds| matches!(one, Holds::Number | Holds::Stamp);
        let rows: Vec<&Vec<Holds>> =
            self.held.iter().filter(|held| held.len() == self.width && held.iter().any(holds_data)).collect();
        (0..self.width).map(|i| 2 * rows.iter().filter(|held| holds_data(&held[i])).count() > rows.len()).collect()
    }

    /// Index of the first row, or the number of lines if there are no rows.
    fn begin(&self) -> usize {
        let usual = self.usual();
        let is_labelled = |held: &Vec<Holds>| self.has_empty_side && held[0] == Holds::Words;
        let is_row = |held: &Vec<Holds>| {
            held.len() == self.width
                && !is_labelled(held)
                && held.iter().any(|one| matches!(one, Holds::Number | Holds::Stamp))
                && held.iter().zip(&usual).all(|(one, usual)| !usual || *one != Holds::Words)
        };
        let are_rows: Vec<bool> = self.held.iter().map(is_row).collect();
        let most = BEGINNING.min(are_rows.iter().filter(|is_row| **is_row).count());
        let from = (most > 0).then(|| are_rows.windows(most).position(|few| few.iter().all(|one| *one))).flatten();
        from.or_else(|| are_rows.iter().position(|is_row| *is_row)).unwrap_or(are_rows.len())
    }
}

fn has_empty_side(held: &[Vec<Holds>], width: usize) -> bool {
    let rows = || held.iter().filter(|held| held.len() == width && held.contains(&Holds::Number));
    let is_side = |held: &Vec<Holds>| matches!(held[0], Holds::Nothing | Holds::Words);
    rows().all(is_side) && 2 * rows().filter(|held| held[0] == Holds::Nothing).count() > rows().count()
}

/// The line with the names of the columns.
struct Names {
    at: usize,
    /// Index and cells of the line of units.
    units: Option<(usize, Vec<String>)>,
    cells: Vec<String>,
    /// Whether further header lines follow.
    heads_block: bool,
}

/// Labels of the lines in a block, letters and digits only.
const NAMES: [&str; 9] =
    ["name", "names", "tracename", "channel", "channelname", "signal", "signalname", "symbolname", "kanalname"];
const UNITS: [&str; 5] = ["unit", "units", "unitstring", "vunit", "einheit"];

fn is_label(cell: &[u8], labels: &[&str]) -> bool {
    let plain: Vec<u8> = cell.iter().filter(|byte| byte.is_ascii_alphanumeric()).map(u8::to_ascii_lowercase).collect();
    labels.iter().any(|label| label.as_bytes() == plain)
}

impl Survey {
    fn names(&self, lines: &[Line<'_>], begin: usize) -> Option<Names> {
        let fits = |cells: &[Vec<u8>]| cells.len() > 1 && (cells.len() as i64 - self.width as i64).abs() <= 1;
        let words = |cells: &[Vec<u8>]| cells.iter().all(|cell| !matches!(holds(cell), Holds::Number | Holds::Stamp));
        let is_some = |cells: &[Vec<u8>]| cells.iter().any(|cell| holds(cell) == Holds::Words);
        if let Some(names) = self.labelled(lines, begin) {
            return Some(names);
        }
        let plain = |at: usize| (!is_comment(lines[at].text)).then(|| self.rows[at].clone());
        // A comment may have another separator than the rows.
        let other = |at: usize| {
            let bare = uncommented(lines[at].text);
            let parted = std::iter::once(self.separator).chain(SEPARATORS).map(|separator| cells(bare, separator));
            parted.into_iter().find(|cells| fits(cells))
        };
        let find = |of: &dyn Fn(usize) -> Option<Vec<Vec<u8>>>, is_wide: bool| {
            let found = (0..begin.min(lines.len())).rev().filter_map(|at| Some((at, of(at)?)));
            let mut found = found.into_iter().filter(|(_, c)| words(c) && is_some(c) && (is_wide || fits(c)));
            let last = found.next()?;
            // A line of types below the names repeats its words.
            let is_of_names = |cells: &[Vec<u8>]| !self.repeats(cells) || self.are_mostly_units(cells);
            let is_named = |cells: &[Vec<u8>]| cells.len() == last.1.len() && self.are_distinct(cells);
            let above = found.find(|(_, c)| !is_of_names(&last.1) && is_named(c));
            Some(above.map_or((last.0, last.1, false), |(at, cells)| (at, cells, true)))
        };
        let wide = |at: usize| plain(at).filter(|cells| cells.len() > 1);
        let (at, found, heads_block) =
            find(&plain, false).or_else(|| find(&other, false)).or_else(|| find(&wide, true)).or_else(|| {
                // Without a number in the text, the first line holds the names.
                (begin == lines.len() && !lines.is_empty()).then(|| (0, self.rows[0].clone(), false))
            })?;
        let text = |cells: &[Vec<u8>]| self.words(cells);
        if at > 0 && self.are_mostly_units(&found) {
            let above = plain(at - 1).filter(|cells| fits(cells)).or_else(|| other(at - 1));
            // Words that are not all units may be names below a line of groups.
            let are_named = |above: &[Vec<u8>]| self.are_units(&found) || self.are_distinct(above);
            let are_names = |above: &Vec<Vec<u8>>| is_some(above) && above.len() + 1 >= found.len() && are_named(above);
            if let Some(above) = above.filter(are_names) {
                return Some(Names { at: at - 1, units: Some((at, text(&found))), cells: text(&above), heads_block });
            }
        }
        Some(Names { at, units: None, cells: text(&found), heads_block })
    }

    /// Names from a block of labelled lines.
    fn labelled(&self, lines: &[Line<'_>], begin: usize) -> Option<Names> {
        let block = || (0..begin.min(lines.len())).filter(|at| self.rows[*at].len().abs_diff(self.width) <= 1);
        let filled = |at: usize| self.rows[at].iter().filter(|cell| !cell.is_empty()).count();
        // The line with most cells, because a title may have the same label. The first one, if several have as many.
        let find = |labels: &[&str]| {
            let found = block().filter(|at| self.rows[*at].len() > 1 && is_label(&self.rows[*at][0], labels));
            found.rev().max_by_key(|at| filled(*at))
        };
        let at = find(&NAMES)?;
        let units = find(&UNITS).filter(|units| *units > at);
        if units.is_none() && !self.has_empty_side {
            return None;
        }
        let mut cells = self.words(&self.rows[at]);
        // The numbers below the label are the time of the other columns, unless one of these is the time.
        let is_named = self.has_empty_side || !self.usual()[0];
        if !is_named && !cells[1..].contains(&cells[0]) && !cells[1..].iter().any(|name| names_time(name)) {
            "time".clone_into(&mut cells[0]);
        }
        let units = units.map(|at| (at, self.words(&self.rows[at])));
        Some(Names { at, units, cells, heads_block: true })
    }

    /// Whether one word is in three or more cells, or in all cells, apart from the label of the line.
    fn repeats(&self, cells: &[Vec<u8>]) -> bool {
        let words = self.words(cells).into_iter().skip(usize::from(self.has_empty_side));
        let words: Vec<String> = words.filter(|word| !word.is_empty()).collect();
        let most = words.iter().map(|word| words.iter().filter(|other| *other == word).count()).max().unwrap_or(0);
        most > 2 || (most == 2 && words.len() == 2)
    }

    /// Whether every column, except one at most, has a name of its own.
    fn are_distinct(&self, cells: &[Vec<u8>]) -> bool {
        let words = self.words(cells);
        let distinct: HashSet<&String> = words.iter().filter(|word| !word.is_empty()).collect();
        distinct.len() + 1 >= words.len()
    }

    /// Cells of a header line, without the label of the line.
    fn words(&self, cells: &[Vec<u8>]) -> Vec<String> {
        let is_side = |i: usize, cell: &[u8]| i == 0 && self.has_empty_side && is_label(cell, &NAMES);
        let is_none = |i: usize, cell: &[u8]| is_side(i, cell) || is_label(cell, &UNITS);
        let text = |(i, cell): (usize, &Vec<u8>)| if is_none(i, cell) { String::new() } else { name_of(cell) };
        cells.iter().enumerate().map(text).collect()
    }

    /// Whether every cell holds a unit or is empty.
    fn are_units(&self, cells: &[Vec<u8>]) -> bool {
        let (known, foreign) = self.units_in(cells);
        known > 0 && foreign == 0
    }

    /// Whether more cells hold a unit than another word, which is then an unknown unit.
    fn are_mostly_units(&self, cells: &[Vec<u8>]) -> bool {
        let (known, foreign) = self.units_in(cells);
        known > foreign
    }

    /// Number of cells with a known unit, and of cells with another word.
    fn units_in(&self, cells: &[Vec<u8>]) -> (usize, usize) {
        let texts: Vec<String> = self.words(cells).iter().map(|text| bare_unit(text)).collect();
        let known = texts.iter().filter(|text| Unit::parse(text).is_some()).count();
        let foreign = texts.iter().filter(|text| !is_unit_word(text) && Unit::parse(text).is_none()).count();
        (known, foreign)
    }

    /// Columns from the rows `after` the names, and names without a column.
    fn columns(&self, after: usize, names: Option<&Names>) -> (Vec<Column>, Vec<String>) {
        let is_row = |row: &&Vec<Vec<u8>>| row.len() == self.width;
        let rows: Vec<&Vec<Vec<u8>>> = self.rows[after.min(self.rows.len())..].iter().filter(is_row).collect();
        let contents: Vec<Content> = (0..self.width).map(|i| content(rows.iter().map(|row| &row[i][..]))).collect();
        let units = names.and_then(|names| names.units.as_ref()).map_or(&[][..], |(_, units)| units);
        let mut words = names.map(|names| names.cells.clone()).unwrap_or_default();
        let mut extra = Vec::new();
        // If the widths differ by more, every row is reported.
        let width = if words.is_empty() || words.len().abs_diff(self.width) <= 1 { self.width } else { words.len() };
        // The last name is a column if some rows fill it, for example with comments.
        let is_filled =
            |row: &Vec<Vec<u8>>| row.len() == words.len() && row.last().is_some_and(|cell| !cell.is_empty());
        let width = if self.rows[after.min(self.rows.len())..].iter().any(is_filled) { words.len() } else { width };
        while words.len() > width && !rows.is_empty() {
            extra.extend(words.pop().filter(|name| !name.is_empty()));
        }
        let is_counted = || rows.iter().enumerate().all(|(i, row)| counts(&row[0], i));
        let is_last_empty = contents.last() == Some(&Content::Empty);
        if words.len() + 1 == width && !words.is_empty() && !is_last_empty && is_counted() {
            words.insert(0, String::new());
        }
        let width = if !words.is_empty() && words.len() + 1 == width && !is_last_empty { words.len() } else { width };
        let column = |i: usize| {
            let name = words.get(i).cloned().unwrap_or_default();
            let found = contents.get(i).copied().unwrap_or_else(|| {
                let longer = self.rows[after.min(self.rows.len())..].iter().filter_map(|row| row.get(i));
                content(longer.map(Vec::as_slice))
            });
            Column {
                content: if found == Content::Empty && !name.is_empty() { Content::Numbers } else { found },
                unit: units.get(i).map(|unit| bare_unit(unit)).filter(|unit| !unit.is_empty() && unit != "-"),
                first: rows.iter().take(SHOWN).filter_map(|row| row.get(i)).map(|cell| name_of(cell)).collect(),
                name,
            }
        };
        ((0..width).map(column).collect(), extra)
    }
}

/// Whether a cell holds the number of its row, counted from 0 or 1.
fn counts(cell: &[u8], row: usize) -> bool {
    cell::plain(cell).is_some_and(|value| value == row as f64 || value == row as f64 + 1.0)
}

fn name_of(cell: &[u8]) -> String {
    let text = String::from_utf8_lossy(cell);
    text.split_whitespace().collect::<Vec<&str>>().join(" ")
}

/// `[s]` or `(s)` → `s`.
pub fn bare_unit(text: &str) -> String {
    text.trim().trim_matches(['[', ']', '(', ')', '<', '>']).trim().to_owned()
}

#[cfg(test)]
#[path = "layout_tests.rs"]
mod tests;
