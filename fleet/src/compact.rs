//! Joins the many small files of a partition of the means to one sorted file.
//!
//! The new file is complete and compared with the old ones before these are removed. If the program is interrupted in
//! between, runs are in two files; they are counted once, and the next `compact` removes the old files.

use crate::Fault;
use crate::archive::{
    Archive, ArchiveFile, CREATED_BY_COMPACTION, Content, Inventory, SOURCES, Selection, Source, check,
};
use crate::query::refusal;
use crate::table::facts_of_means;
use datafusion::arrow::array::{ArrayRef, RecordBatch, new_null_array};
use datafusion::arrow::compute::concat_batches;
use datafusion::arrow::datatypes::{Field, FieldRef, Schema, SchemaRef};
use datafusion::parquet::arrow::ArrowWriter;
use datafusion::parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use datafusion::parquet::basic::{Compression, ZstdLevel};
use datafusion::parquet::file::metadata::KeyValue;
use datafusion::parquet::file::properties::WriterProperties;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Compression level, as in the files of the daemon.
const ZSTD_LEVEL: i32 = 3;

/// Result of `jointbench-fleet compact`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Compacted {
    /// Partitions with a new file.
    pub partitions: usize,
    /// Runs in all partitions.
    pub runs: usize,
    /// Files before.
    pub files_before: usize,
    /// Files after.
    pub files_after: usize,
    /// Removed files whose runs were in another file with the same data.
    pub duplicates_removed: usize,
}

/// The rows of one run, with the columns of the files of the daemon.
struct Piece {
    source: Source,
    rows: RecordBatch,
}

/// The files of a partition.
#[derive(Default)]
struct Partition<'i> {
    kept: Vec<&'i ArchiveFile>,
    duplicates: Vec<&'i ArchiveFile>,
}

/// Joins the files of each partition of the means.
///
/// # Errors
/// [`Fault::Input`] for damaged files, also those with another digest than in their footer, and for a file that differs from another one with the same run;
/// [`Fault::Failed`] if a file cannot be written or is not equal when it is read back. No old file is removed then.
pub fn compact(archive: &Archive, selection: &Selection) -> Result<Compacted, Fault> {
    let inventory = Inventory::read(archive, Content::Means, selection)?;
    let mut partitions: BTreeMap<PathBuf, Partition> = BTreeMap::new();
    let folder = |file: &ArchiveFile| file.path.parent().unwrap_or(archive.root()).to_owned();
    inventory.files.iter().for_each(|file| partitions.entry(folder(file)).or_default().kept.push(file));
    inventory.duplicate_files.iter().for_each(|file| partitions.entry(folder(file)).or_default().duplicates.push(file));
    let partitions: Vec<(PathBuf, Partition)> = partitions.into_iter().collect();
    let done: Vec<Compacted> =
        partitions.par_iter().map(|(folder, partition)| join(folder, partition)).collect::<Result<_, Fault>>()?;
    Ok(done.iter().fold(Compacted::default(), |sum, one| Compacted {
        partitions: sum.partitions + one.partitions,
        runs: sum.runs + one.runs,
        files_before: sum.files_before + one.files_before,
        files_after: sum.files_after + one.files_after,
        duplicates_removed: sum.duplicates_removed + one.duplicates_removed,
    }))
}

fn join(folder: &Path, partition: &Partition) -> Result<Compacted, Fault> {
    let Partition { kept, duplicates } = partition;
    let mut done = Compacted {
        runs: kept.iter().map(|file| file.sources.len()).sum(),
        files_before: kept.len() + duplicates.len(),
        files_after: kept.len() + duplicates.len(),
        ..Compacted::default()
    };
    if kept.is_empty() || (kept.len() == 1 && duplicates.is_empty()) {
        return Ok(done);
    }
    let schema = united(kept.iter().chain(duplicates).copied());
    let mut pieces = pieces(kept, &schema)?;
    pieces.sort_by(|a, b| order(&a.source).cmp(&order(&b.source)));
    for file in duplicates {
        compare(file, &pieces, &schema)?;
    }
    let mut obsolete = duplicates.clone();
    if kept.len() > 1 {
        write(folder, &pieces, &schema)?;
        obsolete.extend(kept);
        done.files_after = 1;
        done.partitions = 1;
    } else {
        done.files_after = kept.len();
    }
    for file in obsolete {
        fs::remove_file(&file.path).map_err(|fault| Fault::Failed(format!("{}: {fault}", file.path.display())))?;
    }
    done.duplicates_removed = duplicates.len();
    Ok(done)
}

/// By unit and time.
fn order(source: &Source) -> (Option<&str>, &str, &str, usize, &str) {
    (source.serial(), source.created_at(), source.store(), source.run().len(), source.run())
}

/// All columns of some files, without the facts that `compact` adds.
fn united<'f>(files: impl IntoIterator<Item = &'f ArchiveFile>) -> SchemaRef {
    let mut fields: Vec<FieldRef> = Vec::new();
    for file in files {
        let added: Vec<&str> = if file.is_compacted { added(&file.sources[0]) } else { Vec::new() };
        for field in file.schema.fields().iter().filter(|field| !added.contains(&field.name().as_str())) {
            if !fields.iter().any(|known| known.name() == field.name()) {
                fields.push(Arc::new(Field::new(field.name(), field.data_type().clone(), true)));
            }
        }
    }
    Arc::new(Schema::new(fields))
}

fn added(source: &Source) -> Vec<&'static str> {
    facts_of_means(source).map(|facts| facts.into_iter().map(|(name, _)| name).collect()).unwrap_or_default()
}

fn pieces(files: &[&ArchiveFile], schema: &SchemaRef) -> Result<Vec<Piece>, Fault> {
    let mut all = Vec::new();
    for file in files {
        check(file).map_err(|damaged| refusal(&damaged))?;
        let rows = read(&file.path, schema)?;
        let mut start = 0;
        for source in &file.sources {
            all.push(Piece { source: source.clone(), rows: rows.slice(start, source.rows) });
            start += source.rows;
        }
    }
    Ok(all)
}

/// The rows of a file with the columns of a schema. Other columns of the file are omitted, absent ones have no values.
fn read(path: &Path, schema: &SchemaRef) -> Result<RecordBatch, Fault> {
    let damaged = |reason: String| refusal(&crate::archive::Damaged { file: path.display().to_string(), reason });
    let file = File::open(path).map_err(|fault| damaged(fault.to_string()))?;
    let builder = ParquetRecordBatchReaderBuilder::try_new(file).map_err(|fault| damaged(fault.to_string()))?;
    let own = builder.schema().clone();
    let reader = builder.build().map_err(|fault| damaged(fault.to_string()))?;
    let batches: Vec<RecordBatch> = reader.collect::<Result<_, _>>().map_err(|fault| damaged(fault.to_string()))?;
    let whole = concat_batches(&own, &batches).map_err(|fault| damaged(fault.to_string()))?;
    let column = |field: &FieldRef| {
        let found = whole.column_by_name(field.name()).cloned();
        found.unwrap_or_else(|| new_null_array(field.data_type(), whole.num_rows()))
    };
    let columns: Vec<ArrayRef> = schema.fields().iter().map(column).collect();
    RecordBatch::try_new(schema.clone(), columns).map_err(|fault| damaged(fault.to_string()))
}

/// Refuses a file whose rows differ from those of the same run in another file.
fn compare(file: &ArchiveFile, pieces: &[Piece], schema: &SchemaRef) -> Result<(), Fault> {
    for own in self::pieces(&[file], schema)? {
        let is_same =
            |piece: &&Piece| (piece.source.store(), piece.source.run()) == (own.source.store(), own.source.run());
        if let Some(piece) = pieces.iter().find(is_same)
            && piece.rows != own.rows
        {
            let (path, run) = (file.path.display(), own.source.run());
            return Err(Fault::Input(format!(
                "{path}: run {run} has other rows in another file: move one of them away"
            )));
        }
    }
    Ok(())
}

/// Writes the new file, reads it back, and gives it its name.
fn write(folder: &Path, pieces: &[Piece], schema: &SchemaRef) -> Result<(), Fault> {
    let name = format!("compact-{:016x}.parquet", digest(pieces));
    let (path, staged) = (folder.join(&name), folder.join(format!("{name}.part")));
    let failed = |fault: &dyn std::fmt::Display| Fault::Failed(format!("{}: {fault}", path.display()));
    encode(&staged, pieces, schema).map_err(|fault| failed(&fault))?;
    let back = read(&staged, schema)?;
    let mut start = 0;
    for piece in pieces {
        if back.slice(start, piece.source.rows) != piece.rows {
            return Err(failed(&format!("run {} is not equal when it is read back", piece.source.run())));
        }
        start += piece.source.rows;
    }
    // The name must not reach the disk before the content. A link never replaces another file.
    File::open(&staged).and_then(|file| file.sync_all()).map_err(|fault| failed(&fault))?;
    fs::hard_link(&staged, &path).map_err(|fault| failed(&fault))?;
    fs::remove_file(&staged).map_err(|fault| failed(&fault))
}

/// FNV-1a over the runs and their digests: the same runs give the same name.
fn digest(pieces: &[Piece]) -> u64 {
    let texts = pieces.iter().flat_map(|piece| [piece.source.store(), piece.source.run(), piece.source.sha256()]);
    let bytes = texts.flat_map(|text| text.bytes().chain([0]));
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

fn encode(path: &Path, pieces: &[Piece], schema: &SchemaRef) -> Result<(), Box<dyn std::error::Error>> {
    let sources: Vec<&Source> = pieces.iter().map(|piece| &piece.source).collect();
    let facts: Vec<FieldRef> = facts_of_means(sources[0])?
        .iter()
        .map(|(name, value)| Arc::new(Field::new(*name, value.data_type(), true)))
        .collect();
    let whole = Arc::new(Schema::new([&schema.fields()[..], &facts].concat()));
    let footer = [
        ("jointbench.schema_version", "1".to_owned()),
        ("jointbench.content", Content::Means.name().to_owned()),
        ("jointbench.written_by", CREATED_BY_COMPACTION.to_owned()),
        (SOURCES, serde_json::to_string(&sources)?),
    ];
    let footer = footer.into_iter().map(|(key, value)| KeyValue::new(key.to_owned(), value)).collect();
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(ZSTD_LEVEL)?))
        .set_key_value_metadata(Some(footer))
        .build();
    let mut writer = ArrowWriter::try_new(File::create(path)?, whole.clone(), Some(properties))?;
    for piece in pieces {
        let mut columns = piece.rows.columns().to_vec();
        for (_, value) in facts_of_means(&piece.source)? {
            columns.push(value.to_array_of_size(piece.source.rows)?);
        }
        writer.write(&RecordBatch::try_new(whole.clone(), columns)?)?;
    }
    writer.close()?;
    Ok(())
}
