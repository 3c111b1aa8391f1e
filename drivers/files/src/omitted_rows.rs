//! Rows that the user omits: a disturbance, a start before the motor turned, a line that is not a sample.

use crate::error::{FileError, FileFault};
use crate::note::{counted, plural};
use crate::options::OptionFault;
use crate::raw::RawTable;
use crate::{Note, ReadOptions};
use jointbench_instrument::Meta;
use std::ops::RangeInclusive;

/// The fact with the number of rows of the file that the run omits.
pub const LEFT_OUT_ROWS: &str = "left_out_rows";

/// Most ranges that a message proposes.
const PROPOSED: usize = 12;

/// `17, 40-52, 900-` → 17..=17, 40..=52, 900..=`u64::MAX`.
pub(crate) fn parse_rows(text: &str) -> Result<Vec<RangeInclusive<u64>>, OptionFault> {
    let fault = || OptionFault::Rows(text.to_owned());
    let number = |text: &str| text.trim().parse::<u64>().ok().filter(|number| *number > 0).ok_or_else(fault);
    let range = |part: &str| {
        let range = match part.split_once(['-', '–']) {
            None => number(part).map(|row| row..=row)?,
            Some((first, last)) if last.trim().is_empty() => number(first)?..=u64::MAX,
            Some((first, last)) => number(first)?..=number(last)?,
        };
        if range.is_empty() { Err(fault()) } else { Ok(range) }
    };
    text.split(',').map(range).collect()
}

/// Ascending numbers in the notation of [`parse_rows`]. `None`: too many ranges for a message.
pub(crate) fn rows_text(rows: &[u64]) -> Option<String> {
    let ranges: Vec<&[u64]> = rows.chunk_by(|before, after| before + 1 == *after).take(PROPOSED + 1).collect();
    let text = |range: &&[u64]| match **range {
        [row] => row.to_string(),
        [first, .., last] => format!("{first}-{last}"),
        [] => String::new(),
    };
    (ranges.len() <= PROPOSED).then(|| ranges.iter().map(text).collect::<Vec<String>>().join(","))
}

impl RawTable {
    /// Omits the rows that the options name. A range without a row of the table is refused: perhaps it counts otherwise.
    pub fn omit_rows(&mut self, file: &str, meta: &mut Meta, options: &ReadOptions) -> Result<(), FileError> {
        if options.omit_rows.is_empty() {
            return Ok(());
        }
        let numbers: Vec<u64> = (0..self.rows).map(|row| self.number_of(row)).collect();
        let is_in = |range: &RangeInclusive<u64>| {
            let from = numbers.partition_point(|number| number < range.start());
            numbers.get(from).is_some_and(|number| range.contains(number))
                || self.odd.iter().any(|odd| range.contains(&odd.line))
        };
        if let Some(range) = options.omit_rows.iter().find(|range| !is_in(range)) {
            let (first, last) = (numbers.first().copied().unwrap_or(0), numbers.last().copied().unwrap_or(0));
            return Err(FileFault::NotOmitted { wanted: *range.start(), first, last }.in_file(file));
        }
        let is_omitted = |number: u64| options.omit_rows.iter().any(|range| range.contains(&number));
        let kept: Vec<usize> = (0..self.rows).filter(|row| !is_omitted(numbers[*row])).collect();
        let odd = self.odd.len();
        self.odd.retain(|odd| !is_omitted(odd.line));
        let omitted = self.rows - kept.len() + odd - self.odd.len();
        if kept.is_empty() {
            return Err(FileFault::AllOmitted.in_file(file));
        }
        self.keep(kept);
        self.count_omitted(meta, omitted);
        self.notes.push(Note::new(format!("{} omitted as asked", plural(omitted, "row"))));
        Ok(())
    }

    /// Omits rows with an empty cell.
    pub fn omit_empty_rows(&mut self, meta: &mut Meta) {
        let whole = |row: &usize| self.columns.iter().all(|column| !column.values[*row].is_nan());
        let kept: Vec<usize> = (0..self.rows).filter(whole).collect();
        let omitted = self.rows - kept.len();
        if omitted == 0 {
            return;
        }
        self.keep(kept);
        self.count_omitted(meta, omitted);
        self.notes.push(Note::with(
            format!("rows omitted for an empty cell: {}", counted(omitted)),
            crate::ProposedOption::flag("leave_empty_rows"),
        ));
    }

    /// The number of omitted rows is a fact of the run.
    fn count_omitted(&mut self, meta: &mut Meta, omitted: usize) {
        self.omitted += omitted;
        meta.other.insert(LEFT_OUT_ROWS.to_owned(), self.omitted.into());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_written_as_they_are_read() {
        assert_eq!(parse_rows("17, 40-52,900-").unwrap(), [17..=17, 40..=52, 900..=u64::MAX]);
        for text in ["", "0", "a", "52-40", "1,,2", "-5"] {
            assert!(parse_rows(text).unwrap_err().to_string().contains("17, 40-52 or 900-"), "{text}");
        }
        assert_eq!(rows_text(&[3, 4, 5, 9]).unwrap(), "3-5,9");
        let many: Vec<u64> = (1..40).map(|row| 2 * row).collect();
        assert_eq!(rows_text(&many), None);
        assert_eq!(rows_text(&many[..PROPOSED]).map(|text| parse_rows(&text).unwrap().len()), Some(PROPOSED));
    }
}
