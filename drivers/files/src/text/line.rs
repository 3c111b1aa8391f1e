//! Lines at the beginning of a text, and their cells.

use super::cell;
use super::stamp;

/// The separator of the columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Separator {
    Sign(u8),
    /// Any number of spaces, also before the first column.
    Blanks,
}

/// In this order the first one of equals is chosen.
pub const SEPARATORS: [Separator; 5] =
    [Separator::Sign(b'\t'), Separator::Sign(b';'), Separator::Sign(b','), Separator::Sign(b'|'), Separator::Blanks];

impl Separator {
    /// The sign between the cells of a line that [`spread`] has normalized.
    pub fn sign(self) -> u8 {
        match self {
            Separator::Sign(sign) => sign,
            Separator::Blanks => b' ',
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Separator::Sign(b'\t') => "tabs",
            Separator::Sign(b';') => "semicolons",
            Separator::Sign(b',') => "commas",
            Separator::Sign(_) => "bars",
            Separator::Blanks => "blanks",
        }
    }
}

/// One line of cells. Quotation marks may contain line ends.
#[derive(Debug, Clone, Copy)]
pub struct Line<'t> {
    /// Its start in the text.
    pub start: usize,
    /// Counted from 1, as in an editor.
    pub number: u64,
    pub text: &'t [u8],
}

/// Largest number of line ends inside quotation marks.
const MOST_INNER_ENDS: usize = 8;

/// The first lines of a text. `is_whole`: the last line is complete.
pub fn lines(text: &[u8], is_whole: bool, most: usize) -> Vec<Line<'_>> {
    let mut found: Vec<Line<'_>> = Vec::new();
    let (mut start, mut number) = (0, 1);
    while start < text.len() && found.len() < most {
        let Some((end, inner)) = end_of(text, start, is_whole) else { break };
        let line = text[start..end].strip_suffix(b"\r").unwrap_or(&text[start..end]);
        found.push(Line { start, number, text: line });
        number += 1 + inner;
        start = end + 1;
    }
    found
}

/// The end of the line, and the number of line ends inside it.
fn end_of(text: &[u8], start: usize, is_whole: bool) -> Option<(usize, u64)> {
    let (mut marks, mut inner, mut first) = (0, 0, None);
    for (at, byte) in text[start..].iter().enumerate() {
        match byte {
            b'"' => marks += 1,
            b'\n' if marks % 2 == 0 => return Some((start + at, inner)),
            b'\n' => {
                first.get_or_insert(start + at);
                inner += 1;
                if inner as usize > MOST_INNER_ENDS {
                    break;
                }
            }
            _ => {}
        }
    }
    // A quotation mark that is never closed is an ordinary character.
    first.map(|end| (end, 0)).or(is_whole.then_some((text.len(), 0)))
}

/// The cells of a line, without quotation marks and surrounding spaces.
pub fn cells(line: &[u8], separator: Separator) -> Vec<Vec<u8>> {
    let mut spread_line = Vec::new();
    let line = match separator {
        Separator::Blanks => {
            spread(line, &mut spread_line);
            &spread_line
        }
        Separator::Sign(_) => line,
    };
    let mut reader =
        csv::ReaderBuilder::new().delimiter(separator.sign()).has_headers(false).flexible(true).from_reader(line);
    let mut record = csv::ByteRecord::new();
    match reader.read_byte_record(&mut record) {
        Ok(true) => record.iter().map(|cell| cell.trim_ascii().to_vec()).collect(),
        _ => Vec::new(),
    }
}

/// Appends lines to `out` with one space between cells and none at the ends.
pub fn spread(text: &[u8], out: &mut Vec<u8>) {
    let (mut is_quoted, mut is_between, mut is_start) = (false, false, true);
    for byte in text {
        match byte {
            b' ' | b'\t' if !is_quoted => is_between = true,
            b'\r' if !is_quoted => {}
            b'\n' if !is_quoted => {
                out.push(b'\n');
                (is_between, is_start) = (false, true);
            }
            byte => {
                if is_between && !is_start {
                    out.push(b' ');
                }
                is_quoted ^= *byte == b'"';
                (is_between, is_start) = (false, false);
                out.push(*byte);
            }
        }
    }
}

pub fn is_comment(line: &[u8]) -> bool {
    let line = line.trim_ascii_start();
    let line = line.strip_prefix(b"\"").unwrap_or(line);
    line.starts_with(b"#") || line.starts_with(b"%") || line.starts_with(b"//")
}

/// A line without the signs that mark it as a comment.
pub fn uncommented(line: &[u8]) -> &[u8] {
    match is_comment(line) {
        true => line.trim_ascii_start().trim_ascii().strip_prefix(b"//").unwrap_or_else(|| {
            let line = line.trim_ascii_start();
            let signs = line.iter().take_while(|byte| matches!(byte, b'#' | b'%')).count();
            &line[signs..]
        }),
        false => line,
    }
}

/// The content of a cell of the first lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holds {
    Number,
    Stamp,
    Truth,
    Nothing,
    Words,
}

pub fn holds(cell: &[u8]) -> Holds {
    match () {
        () if cell::is_missing(cell) => Holds::Nothing,
        () if cell::is_number(cell) => Holds::Number,
        () if stamp::parse(cell).is_some() => Holds::Stamp,
        () if cell::truth(cell).is_some() => Holds::Truth,
        () => Holds::Words,
    }
}
