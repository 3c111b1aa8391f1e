//! Import of run tables. A separate process reads and checks a file and writes its rows to an intermediate file. The
//! daemon stores these rows block by block in one transaction.

use super::statistics::ROWS_AT_ONCE;
use super::units::TestedUnit;
use super::{Answer, Lab, LabError, UPLOADS};
use crate::job::{ImportRequest, Job};
use crate::store::{BLOCK_ROWS, NewRun, RunFilter};
use crate::view::{Run, reread};
use jointbench_files::{Bounds, Note, Preview, ReadOptions, paragraph, parse_meta, preview, understand_upload};
use jointbench_instrument::{Channel, Meta, RunTable, Trace};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::path::Path;
use tempfile::{NamedTempFile, TempPath};
use tokio::sync::mpsc;

/// Provenance of an import: the run with the same samples.
pub const COPY_OF: &str = "copy_of";
/// Provenance of an import: data problems and missing metadata, as sentences.
pub const ATTENTION: &str = "attention";
/// Provenance of an import: skipped and assumed data, in one paragraph.
pub const UNDERSTOOD: &str = "understood";
/// Exported metadata of a simulated run, so that an import does not show it as a hardware run.
pub(super) const SIMULATED: &str = "simulated";

/// Content of a file except for its rows.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Found {
    kind: String,
    meta: Meta,
    channels: Vec<Channel>,
    rows: usize,
    attention: Vec<String>,
    understood: String,
    copy_of: Option<i64>,
}

impl Lab {
    /// A temporary file for an upload, deleted when the path is dropped.
    pub fn upload(&self) -> Answer<(File, TempPath)> {
        let made = match &self.inner.jobs {
            Some(jobs) => NamedTempFile::new_in(jobs.data().join(UPLOADS)),
            None => NamedTempFile::new(),
        };
        let unwritable = |fault| LabError::Internal(format!("the upload cannot be stored: {fault}"));
        Ok(made.map_err(unwritable)?.into_parts())
    }

    /// Imports a file as a run. The whole file is checked first, then stored in one transaction.
    pub async fn import(&self, request: ImportRequest, by: &str) -> Answer<Run> {
        let request = request.with_names()?;
        let name = request.name.clone().unwrap_or_else(|| request.file_name.clone());
        let mut source = json!({ "file": request.file_name });
        for (part, text) in request.choices.parts() {
            match &mut source[part] {
                serde_json::Value::Array(several) => several.push(text.into()),
                none => *none = vec![text].into(),
            }
        }
        let (_, rows) = self.upload()?;
        let uploaded = self.inner.jobs.is_some();
        let found = self.compute(Job::Import { request, rows: rows.to_path_buf(), uploaded }).await?;
        self.keep(&name, source, found, &rows, by).await
    }

    /// Content of a file and proposals for its import; stores nothing.
    pub async fn preview_file(&self, request: ImportRequest) -> Answer<Preview> {
        let request = request.with_names()?;
        let uploaded = self.inner.jobs.is_some();
        self.compute(Job::Preview { request, uploaded }).await
    }

    pub(super) async fn preview_here(&self, request: ImportRequest, uploaded: bool) -> Answer<Preview> {
        let read = move || Ok(preview(&request.file_name, &request.file, &request.options(uploaded)?)?);
        tokio::task::spawn_blocking(read)
            .await
            .map_err(|fault| LabError::Internal(format!("reading the file failed: {fault}")))?
    }

    async fn keep(
        &self,
        name: &str,
        mut source: serde_json::Value,
        found: Found,
        rows: &Path,
        by: &str,
    ) -> Answer<Run> {
        let Found { kind, mut meta, channels, rows: count, attention, understood, copy_of } = found;
        if !attention.is_empty() {
            source[ATTENTION] = attention.into();
        }
        if !understood.is_empty() {
            source[UNDERSTOOD] = understood.into();
        }
        if let Some(original) = copy_of {
            source[COPY_OF] = original.into();
        }
        let simulated = meta.other.get(SIMULATED) == Some(&true.into());
        if simulated {
            meta.other.remove(SIMULATED);
        }
        let tested = TestedUnit::taken_from(&mut meta);
        let provenance = json!({
            "software": concat!("jointbench ", env!("CARGO_PKG_VERSION")),
            "by": by,
            "imported": source,
        });
        let new = NewRun {
            bench: name.to_owned(),
            procedure: "import".to_owned(),
            kind,
            simulated,
            parameters: serde_json::Map::new(),
            provenance: reread(&provenance)?,
            meta: reread(&meta)?,
            unit: tested.unit,
            operator: tested.operator,
        };
        let run = self.inner.store.import_parts(&new, parts(rows, channels, count)).await?;
        tracing::info!(run.id = run, name, rows = count, "run imported");
        self.run(run).await
    }

    /// Reads and checks a file, and writes its rows to the intermediate file.
    pub(super) async fn read_here(&self, request: ImportRequest, rows: &Path, uploaded: bool) -> Answer<Found> {
        let (table, notes) = tokio::task::spawn_blocking(move || read(&request, uploaded))
            .await
            .map_err(|fault| LabError::Internal(format!("reading the file failed: {fault}")))??;
        let attention = jointbench_model::preprocess::attention(&table);
        let understood = paragraph(&notes);
        let kind = table.kind().to_string();
        let (meta, trace) = table.into_parts();
        let copy_of = self.original_of(&kind, &trace).await?;
        write_rows(&trace, rows).map_err(unkept)?;
        Ok(Found { kind, meta, rows: trace.len(), channels: trace.channels().to_vec(), attention, understood, copy_of })
    }

    /// The first stored run with the same samples.
    async fn original_of(&self, kind: &str, trace: &Trace) -> Answer<Option<i64>> {
        let search = Some(format!("kind:{kind} rows={}", trace.len()));
        let (_, alike) = self.inner.store.runs(&RunFilter { limit: u32::MAX, search, ..RunFilter::default() }).await?;
        for run in alike.iter().rev() {
            match self.holds(run.id, trace).await {
                Ok(true) => return Ok(Some(run.id)),
                // Its samples are only in the archive.
                Ok(false) | Err(LabError::Gone(_)) => {}
                Err(fault) => return Err(fault),
            }
        }
        Ok(None)
    }

    async fn holds(&self, run: i64, trace: &Trace) -> Answer<bool> {
        let rows = trace.len();
        for first in (0..rows).step_by(ROWS_AT_ONCE as usize) {
            let last = rows.min(first + ROWS_AT_ONCE as usize);
            let there = self.inner.store.trace(run, None, first as u64..last as u64).await?;
            let same = there.columns().iter().zip(trace.columns()).all(|(there, here)| *there == here[first..last]);
            if there.columns().len() != trace.columns().len() || !same {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

impl ImportRequest {
    fn options(&self, uploaded: bool) -> Answer<ReadOptions> {
        let bounds = if uploaded { Bounds::UPLOADED } else { Bounds::default() };
        let meta = self.meta.as_ref().map(|meta| parse_meta("meta.json", meta.as_bytes())).transpose()?;
        Ok(ReadOptions { bounds, meta, ..self.choices.options()? })
    }
}

fn read(request: &ImportRequest, uploaded: bool) -> Answer<(RunTable, Vec<Note>)> {
    Ok(understand_upload(&request.file_name, &request.file, &request.options(uploaded)?)?.into_run()?)
}

fn unkept(fault: io::Error) -> LabError {
    LabError::Internal(format!("the rows of the file cannot be stored: {fault}"))
}

/// Writes block by block, column by column, each value as eight bytes, little endian.
fn write_rows(trace: &Trace, file: &Path) -> io::Result<()> {
    let mut out = BufWriter::new(File::create(file)?);
    for first in (0..trace.len()).step_by(BLOCK_ROWS) {
        for column in trace.columns() {
            for value in &column[first..column.len().min(first + BLOCK_ROWS)] {
                out.write_all(&value.to_le_bytes())?;
            }
        }
    }
    out.flush()
}

/// The blocks of the intermediate file; reading overlaps with storing.
fn parts(file: &Path, channels: Vec<Channel>, rows: usize) -> mpsc::Receiver<io::Result<Trace>> {
    let (give, take) = mpsc::channel(1);
    let file = file.to_owned();
    tokio::task::spawn_blocking(move || {
        let mut from = match File::open(&file) {
            Ok(file) => BufReader::new(file),
            Err(fault) => return drop(give.blocking_send(Err(fault))),
        };
        for first in (0..rows).step_by(BLOCK_ROWS) {
            let part = part(&mut from, &channels, BLOCK_ROWS.min(rows - first));
            let failed = part.is_err();
            if give.blocking_send(part).is_err() || failed {
                return;
            }
        }
    });
    take
}

fn part(from: &mut impl Read, channels: &[Channel], rows: usize) -> io::Result<Trace> {
    let mut columns = Vec::with_capacity(channels.len());
    let mut bytes = vec![0; rows * size_of::<f64>()];
    for _ in channels {
        from.read_exact(&mut bytes)?;
        columns.push(bytes.as_chunks().0.iter().map(|value| f64::from_le_bytes(*value)).collect());
    }
    Ok(Trace::from_columns(channels.to_vec(), columns))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn rows_that_are_laid_down_are_taken_up_again() {
        let rows = BLOCK_ROWS + 3;
        let column = |step: f64| (0..rows).map(|row| row as f64 * step).collect::<Vec<f64>>();
        let channels = vec![Channel::new("time_s"), Channel::counted("motor_position_rad", 1e-4)];
        let trace = Trace::from_columns(channels.clone(), vec![column(0.004), column(-1e-4)]);
        let file = NamedTempFile::new().unwrap();
        write_rows(&trace, file.path()).unwrap();

        let mut taken = vec![Vec::new(); 2];
        let mut blocks = parts(file.path(), channels.clone(), rows);
        while let Some(part) = blocks.recv().await {
            let part = part.unwrap();
            taken.iter_mut().zip(part.columns()).for_each(|(all, part)| all.extend_from_slice(part));
        }
        assert_eq!(Trace::from_columns(channels.clone(), taken), trace);

        file.as_file().set_len(100).unwrap();
        let cut = parts(file.path(), channels, rows).recv().await.unwrap();
        assert_eq!(cut.unwrap_err().kind(), io::ErrorKind::UnexpectedEof);
    }
}
