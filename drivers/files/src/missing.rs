//! Numbers that mean an empty cell: `-9999`, or `9.9E+37` of instruments (SCPI 1999, volume 1, 7.2.1).

use crate::column::Column;
use crate::error::{FileError, FileFault};
use crate::note::{counted, plural};
use crate::raw::RawTable;
use crate::text::Content;
use crate::{ProposedOption, ReadOptions};

/// Overflow and "not a number" of SCPI instruments, in single precision or as text.
const SCPI: [f64; 2] = [9.9e37, 9.91e37];
const SINGLE: f64 = 1e-6;
/// The distance of a code from all other values, in multiples of their range.
const FAR: f64 = 10.0;
/// Largest fraction of cells with a code. A code not of nines must also be a whole number that occurs more than once and fits into
/// 32 bits.
const SHARE: f64 = 0.1;
const LARGEST: f64 = 4_294_967_296.0;

impl RawTable {
    /// Treats the codes of the options as empty, and asks about numbers that look like a code.
    pub fn settle_missing(&mut self, file: &str, options: &ReadOptions) -> Result<(), FileError> {
        let codes: Vec<f64> = options.missing.iter().filter_map(|text| text.trim().parse().ok()).collect();
        for column in &mut self.columns {
            codes.iter().for_each(|code| column.empty(*code));
        }
        if options.missing.iter().any(|text| text == "none") {
            return Ok(());
        }
        let Some((column, code)) = self.columns.iter().find_map(|column| Some((column, code_of(column)?))) else {
            return Ok(());
        };
        let is_code = |value: &f64| *value == code;
        let (count, rows) = (column.values.iter().copied().filter(is_code).count(), self.rows);
        let row = column.values.iter().position(is_code).unwrap_or_default();
        let text = if is_of_scpi(code) { format!("{code:e}") } else { code.to_string() };
        let verb = if count == 1 { "is" } else { "are" };
        let (count, rows) = (counted(count), plural(rows, "cell"));
        let message = format!("{count} of {rows} {verb} {text}, far from all others: perhaps a code for an empty cell");
        let options = vec![
            ProposedOption::new("missing", text).and_flag("leave_empty_rows"),
            ProposedOption::new("missing", "none"),
        ];
        let place = Box::new(self.located(file, row));
        Err(FileError { place, fault: FileFault::Choice { message, options } }.in_column(&column.name))
    }
}

/// The number in a column that looks like a code: a SCPI code, or a number far from all others that has only nines or
/// repeats.
fn code_of(column: &Column) -> Option<f64> {
    if column.content != Content::Numbers {
        return None;
    }
    let finite = || column.values.iter().copied().filter(|value| value.is_finite());
    let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    [low, high].into_iter().find(|code| {
        let others = || finite().filter(|value| value != code);
        let (low, high) = (others().fold(f64::INFINITY, f64::min), others().fold(f64::NEG_INFINITY, f64::max));
        let distance = (code - low).abs().min((code - high).abs());
        let count = finite().filter(|value| value == code).count();
        let is_repeated = low < high
            && code.fract() == 0.0
            && code.abs() <= LARGEST
            && count > 1
            && count as f64 <= SHARE * column.values.len() as f64;
        low <= high && (is_of_scpi(*code) || (is_of_nines(*code) || is_repeated) && distance > FAR * (high - low))
    })
}

fn is_of_scpi(value: f64) -> bool {
    SCPI.iter().any(|code| (value.abs() / code - 1.0).abs() < SINGLE)
}

/// Whether all digits are nines: 999, -9999, 99999.99.
fn is_of_nines(value: f64) -> bool {
    let text = value.abs().to_string();
    let digits: Vec<char> = text.chars().filter(char::is_ascii_digit).collect();
    digits.len() >= 3 && digits.iter().all(|digit| *digit == '9')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_is_far_from_what_was_measured() {
        let code = |values: &[f64]| code_of(&Column::new("motor_current_a", values.to_vec()));
        assert_eq!(code(&[0.1, -9999.0, 0.3, -0.5]), Some(-9999.0));
        assert_eq!(code(&[0.1, 9.9e37, 0.3]), Some(9.9e37));
        assert_eq!(code(&[0.1, 99999.99, f64::NAN, 0.3]), Some(99999.99));
        assert_eq!(code(&[0.0, 999.0, 1.0, 500.0]), None, "in the range of the others");
        assert_eq!(code(&[0.1, 9.0, 0.3]), None);
        let twice: Vec<f64> = (0..40).map(|i| if i < 2 { -6.124 } else { 1e-3 * f64::from(i % 7) }).collect();
        assert_eq!(code(&twice), None, "codes are whole numbers");
        let often: Vec<f64> = (0..40).map(|i| if i % 13 == 0 { -2_147_483_648.0 } else { f64::from(i) }).collect();
        assert_eq!(code(&often), Some(-2_147_483_648.0));
        let levels: Vec<f64> = (0..40).map(|i| f64::from(i / 39)).collect();
        assert_eq!(code(&levels), None, "a step");
        assert_eq!(code(&[999.0, 999.0]), None, "nothing else");
    }
}
