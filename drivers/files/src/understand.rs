//! Conversion of the table in a file to a run table.

use crate::column::Column;
use crate::error::{FileError, FileFault};
use crate::guess::counts_of;
use crate::note::{Note, counted, plural};
use crate::raw::RawTable;
use crate::text::Decimal;
use crate::unit::{Unit, dimension_of};
use crate::{ProposedOption, ReadOptions, contradiction, facts, guess, naming, operating_points, order, time};
use jointbench_instrument::{Meta, Motion, RunTable, TableFault, Trace};

/// The fact that lets a run have lengths and forces.
const LINEAR: &str = "\"motion\": \"linear\" in the meta file";

/// The interpretation of a file.
#[derive(Debug)]
pub struct Understood {
    pub meta: Meta,
    pub trace: Trace,
    /// Skipped, assumed and noticed items.
    pub notes: Vec<Note>,
    /// Columns of the file that no model can use.
    pub left: Vec<String>,
    /// Probable sources of missing columns.
    guessed: Vec<guess::Proposal>,
    file: String,
    table: RawTable,
    starts: Vec<usize>,
}

impl RawTable {
    pub fn understand(
        mut self,
        file: &str,
        meta: Option<Meta>,
        options: &ReadOptions,
    ) -> Result<Understood, FileError> {
        let mut meta = meta.or_else(|| options.meta.clone()).or(self.meta.take()).unwrap_or_default();
        let in_file = |fault: FileFault| fault.in_file(file);
        self.name_all();
        self.leave(options).map_err(in_file)?;
        self.omit_rows(file, &mut meta, options)?;
        self.settle_missing(file, options)?;
        self.rename(options).map_err(in_file)?;
        let mut notes = std::mem::take(&mut self.notes);
        naming::apply(&mut self.columns, &meta, &mut notes);
        self.notes = notes;
        let asked = options.asked();
        let nearly_full = if meta.kind.is_none() { self.nearly_full() } else { Vec::new() };
        let is_needed = |name: &str| {
            let is_known = meta.kind.is_some_and(|kind| naming::known(kind).any(|known| known == name));
            name == "time_s" || is_known || asked.contains(&name) || nearly_full.iter().any(|needed| needed == name)
        };
        self.refuse_wrong(file, is_needed, options.leave_empty_rows)?;
        self.refuse_doubtful(file, options)?;
        let guessed = meta.kind.map(|kind| guess::guess(&self.columns, kind)).unwrap_or_default();
        let mut left = self.leave_unusable(is_needed, options);
        if self.columns.is_empty() {
            return Err(in_file(FileFault::NoColumns));
        }
        self.refuse_two_clocks().map_err(in_file)?;
        self.settle_units(options, meta.motion).map_err(|fault| fault.at_line(file, self.names_line))?;
        self.scale(options, meta.motion).map_err(in_file)?;
        if options.leave_empty_rows {
            self.omit_empty_rows(&mut meta);
        }
        if let Some((place, note)) = meta.kind.and_then(|kind| contradiction::idle_velocity(&self.columns, kind)) {
            left.push(self.columns.remove(place).name);
            self.notes.push(note);
        }
        let starts = time::settle(&mut self, &mut meta, options, &guessed, file)?;
        let names = self.names();
        let channels = facts::take_resolutions(&mut meta, &names);
        let columns = self.columns.iter_mut().map(|column| std::mem::take(&mut column.values)).collect();
        let trace = Trace::from_columns(channels, columns);
        let notes = std::mem::take(&mut self.notes);
        Ok(Understood { meta, trace, notes, left, guessed, file: file.to_owned(), table: self, starts })
    }

    /// Columns of numbers with few empty cells. Without a kind every column may be needed, and one empty cell does not
    /// make it useless.
    fn nearly_full(&self) -> Vec<String> {
        let is_nearly_full = |column: &&Column| {
            let found = &column.found;
            let is_numbers = column.other_type.is_none() && !column.is_words() && found.wrong_rows.is_empty();
            is_numbers && found.missing > 0 && 2 * found.missing < self.rows
        };
        self.columns.iter().filter(is_nearly_full).map(|column| column.name.clone()).collect()
    }

    /// Refuses a column in which a sign could separate thousands or decimals.
    fn refuse_doubtful(&self, file: &str, options: &ReadOptions) -> Result<(), FileError> {
        if options.decimal_of_all().is_some() {
            return Ok(());
        }
        let is_certain = |column: &Column| column.found.is_decimal || column.found.is_grouped;
        let is_comma = self.decimal == Decimal::Comma;
        let table_is_certain = !is_comma || self.columns.iter().any(is_certain);
        for column in self.columns.iter().filter(|column| options.decimal_of(&column.source).is_none()) {
            let found = &column.found;
            let cell = match (&found.doubtful, &found.three_decimals) {
                (Some(cell), _) if !found.is_grouped => cell,
                (_, Some(cell)) if !is_certain(column) && (found.has_hundreds || !table_is_certain) => cell,
                _ => continue,
            };
            let (sign, decimals, thousands) = match cell.text.contains('.') {
                true => ("point", Decimal::Point, Decimal::Comma),
                false => ("comma", Decimal::Comma, Decimal::Point),
            };
            let value =
                |decimal| crate::text::number(cell.text.as_bytes(), decimal).map_or(f64::NAN, |(value, _)| value);
            let message = format!(
                "“{}” is {} where the {sign} stands before decimals, and {} where it parts thousands",
                cell.text.trim(),
                value(decimals),
                value(thousands)
            );
            let option =
                |decimal: Decimal| ProposedOption::new("decimal", format!("{}={}", column.source, decimal.word()));
            let options = vec![option(decimals), option(thousands)];
            let place = self.located(file, cell.row);
            return Err(FileError { place: Box::new(place), fault: FileFault::Choice { message, options } }
                .in_column(&column.name));
        }
        Ok(())
    }

    /// Refuses channels with their own clocks: a second time column with the same name that differs by more than half a
    /// step.
    fn refuse_two_clocks(&self) -> Result<(), FileFault> {
        let Some(time) = self.place("time_s").map(|place| &self.columns[place]) else { return Ok(()) };
        let (own, step) = (naming::parted(&time.source), order::usual_step(&time.values));
        for other in self.columns.iter().filter(|other| other.name != "time_s") {
            let again = other.source.rsplit_once('_').filter(|(_, number)| number.parse::<usize>().is_ok());
            if again.is_none_or(|(name, _)| naming::parted(name) != own) || own.0.is_empty() {
                continue;
            }
            let apart = time.values.iter().zip(&other.values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            if apart > 0.5 * step {
                let unit = time.unit.as_deref().unwrap_or("its unit");
                let options = vec![ProposedOption::new("leave", &other.source)];
                return Err(FileFault::TwoClocks { apart: format!("{apart:.4} {unit}"), options });
            }
        }
        Ok(())
    }

    /// Drops columns that are not needed and contain words or gaps.
    fn leave_unusable(&mut self, is_needed: impl Fn(&str) -> bool, options: &ReadOptions) -> Vec<String> {
        let (rows, mut left) = (self.rows, Vec::new());
        let mut notes = Vec::new();
        self.columns.retain(|column| {
            let found = &column.found;
            let why = match () {
                () if is_needed(&column.name) => None,
                () if column.other_type.is_some() || column.is_words() => Some("it holds words".to_owned()),
                () if !found.wrong_rows.is_empty() => {
                    let example = found.wrong.first().map_or("", |cell| cell.text.trim());
                    Some(format!(
                        "{} of {} hold no number, such as “{example}”",
                        counted(found.wrong_rows.len()),
                        plural(rows, "cell")
                    ))
                }
                () if found.missing == rows => Some("it is empty".to_owned()),
                () if found.missing > 0 && !options.leave_empty_rows => {
                    Some(format!("{} of {} are empty", counted(found.missing), plural(rows, "cell")))
                }
                () => None,
            };
            if found.truths > 0 && why.is_none() {
                notes.push(Note::with(
                    format!("“{}” is 1 for true and 0 for false", column.name),
                    ProposedOption::new("leave", &column.name),
                ));
            }
            why.is_none_or(|why| {
                notes.push(Note::new(format!("column “{}” is omitted: {why}", column.name)));
                left.push(column.name.clone());
                false
            })
        });
        self.notes.append(&mut notes);
        left
    }

    /// Applies the unit that the file states for a column. A unit that contradicts the column name leads to a question,
    /// because one of both is wrong. A renamed column is converted. A unit of another quantity leads to a question too.
    fn settle_units(&mut self, options: &ReadOptions, motion: Motion) -> Result<(), FileFault> {
        for column in self.columns.iter_mut().filter(|column| column.name != "time_s") {
            let (name, Some(text)) = (column.name.clone(), column.unit.clone()) else { continue };
            let is_stated =
                options.unit.iter().any(|(of, _)| *of == name) || options.scale.iter().any(|(of, _)| *of == name);
            let Some(dimension) = dimension_of(&name).filter(|_| !is_stated) else { continue };
            let si = jointbench_instrument::units::unit_of(&name).unwrap_or_default();
            let option = |unit: &str| {
                let stated = ProposedOption::new("unit", format!("{name}={unit}"));
                // Counts are complete only with their number per turn.
                if counts_of(unit, &name) == Some(unit) { stated.incomplete() } else { stated }
            };
            let asked = |units: &[&str]| {
                let message = format!("the file says {text} for column “{name}”");
                Err(FileFault::Choice { message, options: units.iter().map(|unit| option(unit)).collect() })
            };
            let is_renamed = column.source != name && options.map.iter().any(|(of, _)| *of == name);
            let unit = Unit::parse(&text);
            let fits = unit.is_some_and(|unit| unit.dimension == dimension);
            if fits && unit.is_some_and(Unit::is_si) {
                continue;
            }
            if !is_renamed {
                match fits {
                    true => return asked(&[&text, si]),
                    false => continue,
                }
            }
            let message = match unit {
                Some(unit) if fits || (unit.is_linear() && motion == Motion::Linear) => {
                    column.values.iter_mut().for_each(|value| *value = unit.to_si(*value));
                    format!("“{name}” is “{}”, converted from {text}", column.source)
                }
                Some(unit) if unit.is_linear() => {
                    let message = format!("the file says {text} for column “{name}”, a unit of a linear axis");
                    return Err(FileFault::Choice { message, options: vec![ProposedOption::words(LINEAR)] });
                }
                Some(_) => return asked(&[si]),
                None => match counts_of(&text, &name) {
                    Some(counts) => return asked(&[counts, si]),
                    None => format!("“{name}” is “{}”, read as {si}", column.source),
                },
            };
            self.notes.push(Note::with(message, ProposedOption::open("unit", format!("{name}=UNIT"))));
            column.unit = None;
        }
        Ok(())
    }

    fn scale(&mut self, options: &ReadOptions, motion: Motion) -> Result<(), FileFault> {
        let place = |table: &RawTable, wanted: &String| {
            let fault = || FileFault::Unscaled { wanted: wanted.clone(), there: table.names() };
            table.place(wanted).ok_or_else(fault)
        };
        for (wanted, unit) in &options.unit {
            if unit.is_linear() && motion != Motion::Linear {
                let message = format!("{wanted} has a unit of a linear axis, and the meta file states a rotary one");
                return Err(FileFault::Choice { message, options: vec![ProposedOption::words(LINEAR)] });
            }
            let place = place(self, wanted)?;
            let column = &mut self.columns[place];
            (column.is_unit_open, column.unit) = (false, None);
            column.values.iter_mut().for_each(|value| *value = unit.to_si(*value));
        }
        for (wanted, factor) in &options.scale {
            let place = place(self, wanted)?;
            let column = &mut self.columns[place];
            (column.is_unit_open, column.unit) = (false, None);
            column.values.iter_mut().for_each(|value| *value *= factor);
        }
        // The time is unwrapped after its conversion to seconds.
        for (wanted, period) in options.unwrap.iter().filter(|(wanted, _)| wanted != "time_s") {
            let place = place(self, wanted)?;
            contradiction::unwrap(&mut self.columns[place].values, *period);
        }
        Ok(())
    }
}

impl Understood {
    /// Units in the file for columns that no model uses, by column name.
    pub fn stated_units(&self) -> Vec<(String, String)> {
        let is_known = |name: &str| self.meta.kind.is_some_and(|kind| naming::known(kind).any(|known| known == name));
        let stated = |column: &Column| {
            let unit = column.unit.clone().filter(|_| naming::parted(&column.name).1.is_none())?;
            (column.name != "time_s" && !is_known(&column.name)).then(|| (column.name.clone(), unit))
        };
        self.table.columns.iter().filter_map(stated).collect()
    }

    /// The missing part for a run of its kind, with a probable source in the file. `None`: the table is complete.
    pub fn lacks(&self) -> Option<Note> {
        let Some(kind) = self.meta.kind else {
            return Some(Note::with(
                "no model fits the table yet: its facts state no kind",
                ProposedOption::open("meta", "FILE"),
            ));
        };
        let is_missing = |name: &&&str| self.trace.column(name).is_none();
        let missing: Vec<&str> = kind.required_columns().iter().filter(is_missing).copied().collect();
        let message = match missing[..] {
            [] => return None,
            _ => format!("no {kind} model fits the table yet: it lacks {}", missing.join(", ")),
        };
        let option = self.guessed.iter().map(guess::Proposal::option).reduce(ProposedOption::and_all);
        Some(Note { message, option })
    }

    /// The checked run, and the notes.
    pub fn into_run(self) -> Result<(RunTable, Vec<Note>), FileError> {
        let Understood { meta, trace, mut notes, left, guessed, file, table, starts } = self;
        let refused = |mut fault: TableFault| {
            if let TableFault::MissingColumn { found, .. } = &mut fault {
                found.extend(left.iter().cloned());
            }
            refusal(fault, &file, &table, &guessed)
        };
        let run = match starts.is_empty() {
            true => RunTable::new(meta.clone(), trace).map_err(refused)?,
            false => joined(&meta, &trace, &starts).map_err(|message| {
                FileFault::Choice { message, options: vec![ProposedOption::words("the file without --split-runs")] }
                    .in_file(&file)
            })?,
        };
        if !starts.is_empty() {
            let message = format!("the file holds {} recordings, numbered in column “run”", starts.len() + 1);
            notes.push(Note::with(message, ProposedOption::flag("split_runs")));
        }
        if !meta.operating_points {
            notes.extend(contradiction::proposals(&run));
        }
        Ok((run, notes))
    }
}

/// Joins consecutive recordings into one measurement.
fn joined(meta: &Meta, trace: &Trace, starts: &[usize]) -> Result<RunTable, String> {
    let mut bounds: Vec<usize> = std::iter::once(0).chain(starts.iter().copied()).collect();
    bounds.push(trace.len());
    let parts = bounds.windows(2).map(|pair| {
        let columns = trace.columns().iter().map(|column| column[pair[0]..pair[1]].to_vec()).collect();
        RunTable::new(meta.clone(), Trace::from_columns(trace.channels().to_vec(), columns))
    });
    let mut parts: Vec<RunTable> = parts.collect::<Result<_, _>>().map_err(|fault| fault.to_string())?;
    let first = parts.remove(0);
    first.join(parts).map_err(|fault| fault.to_string())
}

/// The position of the fault, and alternatives that the file seems to contain.
fn refusal(fault: TableFault, file: &str, table: &RawTable, guessed: &[guess::Proposal]) -> FileError {
    let row = fault.row();
    let mut place = match row {
        Some(row) => table.located(file, row),
        None => crate::error::Place { file: file.to_owned(), ..Default::default() },
    };
    // A fault of a whole column is at the line of column names.
    if row.is_none() && table.is_text && fault.column().is_some() {
        place.line = Some(table.names_line);
    }
    let fault = match &fault {
        TableFault::MissingColumn { kind, .. } if table.is_unnamed(*kind) => {
            let options = table.proposed_names.iter().map(|proposed| ProposedOption::open("names", proposed)).collect();
            FileFault::NoNames { kind: *kind, options }
        }
        TableFault::MissingColumn { column, .. } if guessed.iter().any(|one| one.column == *column) => {
            let options = guessed.iter().map(guess::Proposal::option).collect();
            FileFault::Proposed { fault, message: "the file seems to hold it", options }
        }
        TableFault::MissingColumn { kind, column: "time_s", .. } if operating_points::may_be(table, *kind, guessed) => {
            let maps = guessed.iter().map(guess::Proposal::option);
            let options = std::iter::once(ProposedOption::flag("operating_points")).chain(maps).collect();
            FileFault::Proposed { fault, message: "each row may be the mean of one steady operating point", options }
        }
        TableFault::MissingColumn { column: "time_s", .. } => {
            let options = vec![ProposedOption::open("rate", "HZ")];
            FileFault::Proposed { fault, message: "a table without a time has one by its rate", options }
        }
        _ => FileFault::Table(fault),
    };
    FileError { place: Box::new(place), fault }
}
