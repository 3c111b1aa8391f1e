//! A table of a run as a file of the archive, in a separate process: Parquet with its provenance in the footer.

use super::computation::Gathered;
use super::export::{failed, stretches};
use super::{Answer, Lab, LabError};
use crate::archive::{Archive, Digest, Partition, object_path};
use crate::config::ArchiveContent;
use crate::job::{ArchiveRequest, ArchivedFile};
use crate::store::{ArchiveEnd, RunRecord};
use jointbench_files::{Annotations, ParquetWriter};
use jointbench_instrument::zero::TORQUE_ZERO;
use jointbench_instrument::{Channel, Meta, RunTable, Trace};
use jointbench_model::preprocess::prepare;
use jointbench_model::stats::summary::mean;
use jointbench_model::{Options, ResidualKind};
use serde_json::{Map, Value};
use std::ops::Range;

/// Changes with the layout of the files.
const SCHEMA_VERSION: u32 = 1;
/// Columns of the means in addition to the channels of the run.
const DURATION: &str = "duration_s";
const SAMPLES: &str = "samples";

/// The rows of a file: in memory, or those of the store, which are read in stretches.
enum Table {
    Means(Trace),
    Samples { channels: Vec<Channel>, rows: Range<u64> },
}

impl Table {
    fn channels(&self) -> &[Channel] {
        match self {
            Table::Means(means) => means.channels(),
            Table::Samples { channels, .. } => channels,
        }
    }
}

impl Lab {
    /// Writes a table of a run, and reads it back. A file that exists is only compared.
    pub(super) async fn archive_here(&self, request: &ArchiveRequest) -> Answer<ArchiveEnd> {
        let ArchiveRequest { run, content, folder } = request;
        let archive = Archive::open(folder)?;
        let (mut meta, record) = self.export_facts(*run).await?;
        let table = match self.archived_table(*content, &record).await? {
            Ok(table) => table,
            Err(reason) => return Ok(ArchiveEnd::Empty(reason)),
        };
        let sha256 = self.digest(*run, &table).await?;
        let store = self.inner.store.store_id().await?;
        let unit = record.unit.as_ref();
        let (part, batch) = (unit.and_then(|unit| unit.part.as_deref()), unit.and_then(|unit| unit.batch.as_deref()));
        let path = object_path(*content, Partition { part, batch, bench: &record.bench }, &store, *run);
        if archive.find(&path).await?.is_none() {
            let mut more = Annotations { footer: footer(&record, *content, &store, &sha256), labels: Vec::new() };
            if *content == ArchiveContent::Means {
                meta.operating_points = true;
                meta.sample_rate_hz = None;
                // The means are those of the corrected torque.
                meta.other.entry(TORQUE_ZERO).and_modify(|zero| *zero = 0.0.into());
                more.labels = labels(&record);
            }
            self.upload_table(&archive, &path, &table, (&meta, *run), more).await?;
        }
        let bytes = compare(&archive, &path, &sha256).await?;
        Ok(ArchiveEnd::Archived { folder: folder.clone(), path, bytes, sha256 })
    }

    /// Compares a file of the archive with its digest.
    pub(super) async fn check_archived_here(&self, file: &ArchivedFile) -> Answer<()> {
        let ArchivedFile { folder, path, sha256 } = file;
        compare(&Archive::open(folder)?, path, sha256).await.map(drop)
    }

    /// The table, or why the run has none.
    async fn archived_table(&self, content: ArchiveContent, record: &RunRecord) -> Answer<Result<Table, String>> {
        if record.rows == 0 {
            return Ok(Err("the run has no samples".to_owned()));
        }
        if content == ArchiveContent::Samples {
            return Ok(Ok(Table::Samples { channels: record.channels.clone(), rows: 0..record.rows }));
        }
        match self.table(record.id).await {
            Ok(table) => Ok(means(&table).map(Table::Means)),
            Err(LabError::Invalid(reason)) => Ok(Err(reason)),
            Err(fault) => Err(fault),
        }
    }

    async fn digest(&self, run: i64, table: &Table) -> Answer<String> {
        let mut digest = Digest::default();
        match table {
            Table::Means(means) => means.columns().iter().for_each(|column| digest.take(column)),
            Table::Samples { channels, rows } => {
                for channel in channels {
                    let name = [channel.name.clone()];
                    for stretch in stretches(rows) {
                        digest.take(&self.inner.store.trace(run, Some(&name), stretch).await?.columns()[0]);
                    }
                }
            }
        }
        Ok(digest.hex())
    }

    async fn upload_table(
        &self,
        archive: &Archive,
        path: &str,
        table: &Table,
        (meta, run): (&Meta, i64),
        more: Annotations,
    ) -> Answer<()> {
        let encoded = Gathered::default();
        let mut parquet = ParquetWriter::annotated(encoded.clone(), meta, table.channels(), more).map_err(failed)?;
        let mut upload = archive.begin(path).await?;
        let written = async {
            match table {
                Table::Means(means) => parquet.write(means).map_err(failed)?,
                Table::Samples { rows, .. } => {
                    for stretch in stretches(rows) {
                        parquet.write(&self.inner.store.trace(run, None, stretch).await?).map_err(failed)?;
                        upload.write(encoded.take()).await?;
                    }
                }
            }
            parquet.finish().map_err(failed)?;
            upload.write(encoded.take()).await?;
            upload.flush().await
        };
        if let Err(fault) = written.await {
            upload.abort().await;
            return Err(fault);
        }
        // Another program may have written the file in the meantime: the comparison that follows decides.
        upload.finish().await.map(drop)
    }
}

/// Size of a file that has this digest.
async fn compare(archive: &Archive, path: &str, sha256: &str) -> Answer<u64> {
    let Some((file, bytes)) = archive.find(path).await? else {
        return Err(LabError::Conflict(format!("{path} is not in the archive")));
    };
    match Digest::of_file(&file, path)? {
        found if found == sha256 => Ok(bytes),
        found => Err(LabError::Conflict(format!(
            "{path} in the archive has other data (SHA-256 {found}, expected {sha256}): move that file away"
        ))),
    }
}

/// The mean of each channel over each steady state, in the order of time.
fn means(run: &RunTable) -> Result<Trace, String> {
    let options = Options { residual: Some(ResidualKind::PlateauMean), ..Options::default() };
    let states = prepare(run, &options).map_err(|fault| fault.to_string())?.steady_states();
    if states.is_empty() {
        return Err(format!("a {} run has no means at steady state", run.kind()));
    }
    let mean = |values: &[f64]| -> Vec<f64> {
        let over = |rows: &Range<usize>| mean(&values[rows.clone()]);
        states.iter().map(|(_, rows)| over(rows)).collect()
    };
    let trace = run.trace();
    let mut channels: Vec<Channel> = trace.channels().iter().map(|channel| Channel::new(&channel.name)).collect();
    let mut columns: Vec<Vec<f64>> = trace.columns().iter().map(|column| mean(column)).collect();
    let time_s = &trace.columns()[0];
    channels.extend([Channel::new(DURATION), Channel::new(SAMPLES)]);
    columns.push(states.iter().map(|(_, rows)| time_s[rows.end - 1] - time_s[rows.start]).collect());
    columns.push(states.iter().map(|(_, rows)| rows.len() as f64).collect());
    Ok(Trace::from_columns(channels, columns))
}

/// Texts that are the same in each row of the means, because queries join many files.
fn labels(record: &RunRecord) -> Vec<(&'static str, Option<String>)> {
    let unit = record.unit.as_ref();
    vec![
        ("serial", unit.map(|unit| unit.serial.clone())),
        ("revision", unit.and_then(|unit| unit.revision.clone())),
        ("procedure", Some(record.procedure.clone())),
        ("started_at", record.started_at.clone()),
        ("run", Some(record.id.to_string())),
    ]
}

fn footer(record: &RunRecord, content: ArchiveContent, store: &str, sha256: &str) -> Vec<(&'static str, String)> {
    let mut footer = vec![
        ("jointbench.schema_version", SCHEMA_VERSION.to_string()),
        ("jointbench.content", content.name().to_owned()),
        ("jointbench.store", store.to_owned()),
        ("jointbench.run", record.id.to_string()),
        ("jointbench.bench", record.bench.clone()),
        ("jointbench.procedure", record.procedure.clone()),
        ("jointbench.state", record.state.name().to_owned()),
        ("jointbench.created_at", record.created_at.clone()),
        ("jointbench.calibrations", Value::Object(calibrations(record)).to_string()),
        ("jointbench.software_version", env!("CARGO_PKG_VERSION").to_owned()),
        ("jointbench.sha256", sha256.to_owned()),
    ];
    if let Some(unit) = &record.unit {
        footer.push(("jointbench.serial", unit.serial.clone()));
        footer.extend(unit.part.clone().map(|part| ("jointbench.part", part)));
        footer.extend(unit.revision.clone().map(|revision| ("jointbench.revision", revision)));
        footer.extend(unit.batch.clone().map(|batch| ("jointbench.batch", batch)));
    }
    let revision = option_env!("JOINTBENCH_REVISION");
    footer.extend(revision.map(|revision| ("jointbench.software_revision", revision.to_owned())));
    footer
}

/// Dates of the certificates by instrument, and the results of earlier runs that the run has used.
fn calibrations(record: &RunRecord) -> Map<String, Value> {
    let used = record.meta.iter().filter(|(fact, _)| fact.ends_with("_of_run") || *fact == TORQUE_ZERO);
    let mut found: Map<String, Value> = used.map(|(fact, value)| (fact.clone(), value.clone())).collect();
    found.insert("certificates".to_owned(), record.provenance.get("calibrated").cloned().unwrap_or_default());
    found
}
