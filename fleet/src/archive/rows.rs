//! The rows of a file as run tables, as `jointbench import` reads them.

use super::inventory::ArchiveFile;
use super::{Damaged, Source};
use datafusion::arrow::array::{Array, AsArray};
use datafusion::arrow::datatypes::{DataType, Float64Type};
use datafusion::parquet::arrow::ProjectionMask;
use datafusion::parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use jointbench_instrument::zero::TORQUE_ZERO;
use jointbench_instrument::{Channel, RunTable, Trace};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Columns of doubles that `compact` adds; they are facts of a run and no channels.
pub(crate) const ADDED_NUMBERS: [&str; 2] = ["torque_constant_nm_per_a", "gear_ratio"];

/// Columns of doubles of a file. A value that is absent is NaN.
struct Columns {
    names: Vec<String>,
    values: Vec<Vec<f64>>,
    /// Whether a value is absent, for each column with such values.
    absent: Vec<Option<Vec<bool>>>,
}

/// A run of a file with its table, or why the table is refused.
pub type SourceTable<'f> = (&'f Source, Result<RunTable, String>);

/// The run tables of a file.
///
/// # Errors
/// The damaged file.
pub fn run_tables(file: &ArchiveFile) -> Result<Vec<SourceTable<'_>>, Damaged> {
    let columns = guarded(file, || read(file))?;
    let mut start = 0;
    let tables = file.sources.iter().map(|source| {
        let rows = start..start + source.rows;
        start = rows.end;
        (source, table(source, &columns, rows))
    });
    Ok(tables.collect())
}

/// Reads all values of a file.
///
/// # Errors
/// The damaged file.
pub fn check(file: &ArchiveFile) -> Result<(), Damaged> {
    guarded(file, || read(file)).map(drop)
}

/// The decoders panic on some broken files.
fn guarded<T>(file: &ArchiveFile, read: impl FnOnce() -> Result<T, String>) -> Result<T, Damaged> {
    let read = catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| Err("its parts contradict each other".into()));
    read.map_err(|reason| Damaged { file: file.path.display().to_string(), reason })
}

fn read(file: &ArchiveFile) -> Result<Columns, String> {
    let opened = File::open(&file.path).map_err(|fault| fault.to_string())?;
    let builder = ParquetRecordBatchReaderBuilder::try_new(opened).map_err(|fault| fault.to_string())?;
    let is_channel = |name: &str| !file.is_compacted || !ADDED_NUMBERS.contains(&name);
    let fields = builder.schema().fields().iter().enumerate();
    let numbers = fields.filter(|(_, f)| *f.data_type() == DataType::Float64 && is_channel(f.name()));
    let (places, names): (Vec<usize>, Vec<String>) = numbers.map(|(place, f)| (place, f.name().clone())).unzip();
    let mask = ProjectionMask::roots(builder.parquet_schema(), places);
    let batches = builder.with_projection(mask).build().map_err(|fault| fault.to_string())?;
    let mut columns = Columns { values: vec![Vec::new(); names.len()], absent: vec![None; names.len()], names };
    for batch in batches {
        let batch = batch.map_err(|fault| fault.to_string())?;
        for (place, array) in batch.columns().iter().enumerate() {
            let array = array.as_primitive::<Float64Type>();
            let values = &mut columns.values[place];
            if array.null_count() > 0 {
                let absent = columns.absent[place].get_or_insert_with(Vec::new);
                absent.resize(values.len(), false);
                absent.extend((0..array.len()).map(|row| array.is_null(row)));
            }
            values.extend_from_slice(array.values());
        }
    }
    verify(file, &columns)?;
    Ok(columns)
}

/// Compares a file of the daemon with the digest in its footer: all columns of doubles, one after the other, each value
/// as eight bytes, little endian. The columns of a file of `compact` were compared when it was written.
fn verify(file: &ArchiveFile, columns: &Columns) -> Result<(), String> {
    let [source] = &file.sources[..] else { return Ok(()) };
    if file.is_compacted {
        return Ok(());
    }
    let mut digest = Sha256::new();
    columns.values.iter().flatten().for_each(|value| digest.update(value.to_le_bytes()));
    let found: String = digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
    match found == source.sha256() {
        true => Ok(()),
        false => Err(format!("its data have the SHA-256 {found}, its footer says {}", source.sha256())),
    }
}

/// The rows of one run. A column without a value in any of them belongs to other runs of the file.
fn table(source: &Source, columns: &Columns, rows: std::ops::Range<usize>) -> Result<RunTable, String> {
    let mut present = Vec::new();
    for (place, name) in columns.names.iter().enumerate() {
        let absent = columns.absent[place].as_ref();
        match rows.clone().filter(|row| absent.is_some_and(|absent| absent.get(*row) == Some(&true))).count() {
            0 => present.push(place),
            empty if empty == rows.len() => {}
            empty => return Err(format!("column {name} has {empty} empty cells")),
        }
    }
    let channels = present.iter().map(|place| Channel::new(&columns.names[*place])).collect();
    let values = present.iter().map(|place| columns.values[*place][rows.clone()].to_vec()).collect();
    let mut conditions = source.conditions()?;
    // The daemon subtracts the zero of the torque sensor before it averages: it is not subtracted again.
    if conditions.operating_points {
        conditions.other.remove(TORQUE_ZERO);
    }
    RunTable::new(conditions, Trace::from_columns(channels, values)).map_err(|fault| fault.to_string())
}
