//! A table as it stands in a file, before names, units and values are checked.

use crate::error::{FileError, FileFault, Place};
use crate::{Form, ReadOptions, csv_in, facts};
use jointbench_instrument::{Meta, RunTable, Trace};

/// The fact that says how many rows of the file were left out for their empty cells.
pub const LEFT_OUT_ROWS: &str = "left_out_rows";

pub(crate) struct RawTable {
    pub names: Vec<String>,
    pub columns: Vec<Vec<f64>>,
    pub meta: Option<Meta>,
}

impl RawTable {
    /// Renames, scales and checks. `bytes` is the whole file: only a refusal looks into it again, for the line.
    pub fn into_table(
        mut self,
        name: &str,
        bytes: &[u8],
        meta: Option<Meta>,
        options: &ReadOptions,
    ) -> Result<RunTable, FileError> {
        self.leave(options).map_err(|fault| fault.in_file(name))?;
        self.rename(options).map_err(|fault| fault.in_file(name))?;
        self.scale(options).map_err(|fault| fault.in_file(name))?;
        let mut meta = meta.or_else(|| options.meta.clone()).or(self.meta.take()).unwrap_or_default();
        let places = options.leave_empty_rows.then(|| self.leave_empty_rows(&mut meta));
        let channels = facts::take_resolutions(&mut meta, &self.names);
        RunTable::new(meta, Trace::from_columns(channels, self.columns)).map_err(|fault| {
            let mut place = Place { file: name.to_owned(), ..Place::default() };
            let row = fault.row().map(|row| places.as_ref().map_or(row, |places| places[row]));
            match (row, Form::of(name)) {
                (Some(row), Some(Form::Csv)) => place.line = csv_in::line_of(bytes, row),
                (Some(row), Some(Form::GzippedCsv)) => {
                    place.line =
                        csv_in::gunzip(name, bytes, &options.bounds).ok().and_then(|text| csv_in::line_of(&text, row));
                }
                (Some(row), _) => place.row = Some(row as u64 + 1),
                // A column as a whole is at fault: the line of column names.
                (None, Some(Form::Csv | Form::GzippedCsv)) if fault.column().is_some() => place.line = Some(1),
                (None, _) => {}
            }
            FileError { place: Box::new(place), fault: FileFault::Table(fault) }
        })
    }

    fn leave(&mut self, options: &ReadOptions) -> Result<(), FileFault> {
        for wanted in &options.leave {
            let place = self.names.iter().position(|name| name == wanted);
            let place =
                place.ok_or_else(|| FileFault::NotLeft { wanted: wanted.clone(), there: self.names.clone() })?;
            self.names.remove(place);
            self.columns.remove(place);
        }
        Ok(())
    }

    /// The rows that stay, by their places in the file.
    fn leave_empty_rows(&mut self, meta: &mut Meta) -> Vec<usize> {
        let rows = self.columns.first().map_or(0, Vec::len);
        let whole = |row: &usize| self.columns.iter().all(|column| !column[*row].is_nan());
        let places: Vec<usize> = (0..rows).filter(whole).collect();
        if places.len() < rows {
            self.columns = self.columns.iter().map(|c| places.iter().map(|row| c[*row]).collect()).collect();
            meta.other.insert(LEFT_OUT_ROWS.to_owned(), (rows - places.len()).into());
        }
        places
    }

    fn rename(&mut self, options: &ReadOptions) -> Result<(), FileFault> {
        // All sources are looked up before any name changes, so that two columns can swap their names.
        let places = options.map.iter().map(|(_, column)| {
            let place = self.names.iter().position(|name| name == column);
            place.ok_or_else(|| FileFault::Unmapped { wanted: column.clone(), there: self.names.clone() })
        });
        let places: Vec<usize> = places.collect::<Result<_, _>>()?;
        for (place, (name, _)) in places.into_iter().zip(&options.map) {
            self.names[place] = name.clone();
        }
        Ok(())
    }

    fn scale(&mut self, options: &ReadOptions) -> Result<(), FileFault> {
        for (wanted, factor) in &options.scale {
            let place = self.names.iter().position(|name| name == wanted);
            let place =
                place.ok_or_else(|| FileFault::Unscaled { wanted: wanted.clone(), there: self.names.clone() })?;
            self.columns[place].iter_mut().for_each(|value| *value *= factor);
        }
        Ok(())
    }
}
