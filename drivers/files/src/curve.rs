//! A curve from a file: set-points over time.

use crate::error::{FileError, FileFault};
use crate::{ReadOptions, form};
use std::path::Path;

/// Reads pairs of a time (s) and a value from the first two columns of a table.
///
/// # Errors
/// A file that is no table, or a cell that is no number, with file, line and column.
pub fn read_curve(path: &Path) -> Result<Vec<[f64; 2]>, FileError> {
    let name = path.display().to_string();
    let mut table = form::open(&name, path, &ReadOptions::default())?;
    table.name_all();
    if table.columns.len() < 2 {
        let message = "a curve needs two columns: the time in s, and the value".to_owned();
        return Err(FileFault::Choice { message, options: Vec::new() }.in_file(&name));
    }
    table.columns.truncate(2);
    table.refuse_wrong(&name, |_| true, false)?;
    let [times, values] = [0, 1].map(|place| table.columns[place].values.iter());
    Ok(times.zip(values).map(|(t_s, value)| [*t_s, *value]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_read_in_usual_forms_and_refused_at_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("reference.csv");
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            read_curve(&path)
        };
        let expected = [[0.0, 0.0], [0.5, 0.2], [1.0, -0.25]];
        for text in ["time_s,v\n0,0\n0.5,0.2\n1,-0.25\n", "t;v\n0;0\n0,5;0,2\n1;-0,25\n", "0 0\n0.5 0.2\n1 -0.25\n"] {
            assert_eq!(read(text).unwrap(), expected, "{text}");
        }
        let refused = read("t,v\n0,0\n0.5,fast\n1,0\n").unwrap_err().to_string();
        assert!(refused.contains("reference.csv, line 3, column v: expected a number, found “fast”"), "{refused}");
        assert!(read("t\n0\n1\n").unwrap_err().to_string().contains("two columns"));
    }
}
