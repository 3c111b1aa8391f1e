//! Run tables in and out.

use super::{Answer, Lab, LabError};
use crate::store::{NewRun, RunFilter, RunRecord};
use crate::view::Run;
use jointbench_files::{
    LEFT_OUT_ROWS, ReadOptions, meta_json, parse_map, parse_meta, parse_scale, read_bytes, write_csv, write_mat,
    write_parquet,
};
use jointbench_instrument::{Meta, RunTable, Trace};
use serde::Deserialize;
use serde_json::json;
use utoipa::ToSchema;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum FileFormat {
    Csv,
    Parquet,
    /// For MATLAB, Octave and SciPy; out only
    Mat,
}

impl FileFormat {
    pub fn extension(self) -> &'static str {
        match self {
            FileFormat::Csv => "csv",
            FileFormat::Parquet => "parquet",
            FileFormat::Mat => "mat",
        }
    }

    pub fn media_type(self) -> &'static str {
        match self {
            FileFormat::Csv => "text/csv; charset=utf-8",
            FileFormat::Parquet => "application/vnd.apache.parquet",
            FileFormat::Mat => "application/x-matlab-data",
        }
    }
}

/// In the provenance of an import: the run that holds the same samples.
pub const COPY_OF: &str = "copy_of";
/// In the provenance of an import: what its columns and facts contradict or lack, in sentences.
pub const ATTENTION: &str = "attention";
/// Among the facts that leave with a run of a simulated bench, so that it does not come back as one of hardware.
const SIMULATED: &str = "simulated";

/// A measured file with what is needed to read it.
#[derive(Debug, Clone, Default)]
pub struct ImportRequest {
    /// To keep the run under; the file's name where empty.
    pub name: Option<String>,
    /// Tells the form, and stands in messages.
    pub file_name: String,
    pub bytes: Vec<u8>,
    pub meta: Option<String>,
    /// `column=name in the file`.
    pub map: Vec<String>,
    /// `column=factor`.
    pub scale: Vec<String>,
    /// Names in the file.
    pub leave: Vec<String>,
    pub leave_empty_rows: bool,
}

impl Lab {
    /// Takes a file in as a run. It is read and checked whole before anything is kept, and kept in one transaction.
    pub async fn import(&self, request: ImportRequest, by: &str) -> Answer<Run> {
        let request = request.with_names()?;
        let name = request.name.clone().unwrap_or_else(|| request.file_name.clone());
        let source =
            json!({ "file": request.file_name, "map": request.map, "scale": request.scale, "leave": request.leave });
        let table = tokio::task::spawn_blocking(move || read(&request))
            .await
            .map_err(|fault| LabError::Internal(format!("reading the file failed: {fault}")))??;
        self.keep_table(&name, source, table, by).await
    }

    async fn keep_table(&self, name: &str, mut source: serde_json::Value, table: RunTable, by: &str) -> Answer<Run> {
        let kind = table.kind().to_string();
        let mut attention = jointbench_model::prepare::attention(&table);
        if let Some(rows) = table.meta().other.get(LEFT_OUT_ROWS) {
            attention.push(format!("rows left out for an empty cell: {rows}"));
        }
        if !attention.is_empty() {
            source[ATTENTION] = attention.into();
        }
        let (mut meta, trace) = table.into_parts();
        let simulated = meta.other.get(SIMULATED) == Some(&true.into());
        if simulated {
            meta.other.remove(SIMULATED);
        }
        if let Some(original) = self.original_of(&kind, &trace).await? {
            source[COPY_OF] = original.into();
        }
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
            provenance: super::reread(&provenance)?,
            meta: super::reread(&meta)?,
        };
        let rows = trace.len();
        let run = self.inner.store.import(&new, &[], trace).await?;
        tracing::info!(run.id = run, name, rows, "run imported");
        self.run(run).await
    }

    /// The first run of the store that holds the same samples.
    async fn original_of(&self, kind: &str, trace: &Trace) -> Answer<Option<i64>> {
        let rows = trace.len() as u64;
        let search = Some(format!("kind:{kind} rows={rows}"));
        let (_, alike) = self.inner.store.runs(&RunFilter { limit: u32::MAX, search, ..RunFilter::default() }).await?;
        for run in alike.iter().rev() {
            if self.inner.store.trace(run.id, None, 0..rows).await?.columns() == trace.columns() {
                return Ok(Some(run.id));
            }
        }
        Ok(None)
    }

    /// The run, or a stretch of it, as a file, which [`Lab::import`] takes back unchanged.
    pub async fn export(&self, id: i64, format: FileFormat, from_s: Option<f64>, to_s: Option<f64>) -> Answer<Vec<u8>> {
        let (meta, _) = self.leaving(id).await?;
        let rows = self.inner.store.rows_between(id, from_s, to_s).await?;
        let trace = self.inner.store.trace(id, None, rows).await?;
        tokio::task::spawn_blocking(move || write(&meta, &trace, format))
            .await
            .map_err(|fault| LabError::Internal(format!("writing the file failed: {fault}")))?
    }

    /// The facts of a run as they leave with it.
    async fn leaving(&self, id: i64) -> Answer<(Meta, RunRecord)> {
        let (mut meta, record) = self.facts(id).await?;
        if record.simulated {
            meta.other.insert(SIMULATED.to_owned(), true.into());
        }
        Ok((meta, record))
    }

    /// The facts of a run as `meta.json`, for a table that cannot carry them itself.
    pub async fn export_meta(&self, id: i64) -> Answer<String> {
        let (meta, record) = self.leaving(id).await?;
        Ok(meta_json(&meta, &record.channels))
    }
}

fn read(request: &ImportRequest) -> Answer<RunTable> {
    let mut options = ReadOptions {
        leave: request.leave.clone(),
        leave_empty_rows: request.leave_empty_rows,
        ..ReadOptions::default()
    };
    for pair in &request.map {
        options.map.push(parse_map(pair)?);
    }
    for pair in &request.scale {
        options.scale.push(parse_scale(pair)?);
    }
    if let Some(meta) = &request.meta {
        options.meta = Some(parse_meta("meta.json", meta.as_bytes())?);
    }
    Ok(read_bytes(&request.file_name, &request.bytes, &options)?)
}

fn write(meta: &jointbench_instrument::Meta, trace: &Trace, format: FileFormat) -> Answer<Vec<u8>> {
    let mut bytes = Vec::new();
    match format {
        FileFormat::Csv => write_csv(&mut bytes, trace),
        FileFormat::Parquet => write_parquet(&mut bytes, meta, trace),
        FileFormat::Mat => write_mat(&mut bytes, meta, trace),
    }
    .map_err(|fault| LabError::Internal(format!("writing the file failed: {fault}")))?;
    Ok(bytes)
}
