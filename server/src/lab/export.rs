//! Export of run tables section by section, so that a run of any length needs little memory.

use super::spreadsheet::defused_channels;
use super::statistics::ROWS_AT_ONCE;
use super::transfer::SIMULATED;
use super::units::TestedUnit;
use super::{Answer, Lab, LabError};
use crate::job::{Encoding, ExportRequest, FileFormat, Job, Streamed};
use crate::store::RunRecord;
use jointbench_files::{ArrowWriter, CsvWriter, MatWriter, ParquetWriter, meta_json};
use jointbench_instrument::{Channel, Meta};
use std::io::{self, Write};
use std::ops::Range;

impl Lab {
    /// The file in parts. [`Lab::import`] reads it back unchanged.
    pub async fn export(&self, request: ExportRequest) -> Answer<Streamed> {
        // Refuses a missing run before a process is started.
        self.inner.store.run(request.run).await?;
        let job = Job::Export(request);
        match &self.inner.jobs {
            Some(jobs) => jobs.stream(&job).await,
            None => {
                let (give, take) = tokio::sync::mpsc::channel(1);
                let whole = self.answer(job).await?;
                // The channel has capacity for one item.
                let _ = give.try_send(Ok(whole.into()));
                Ok(take)
            }
        }
    }

    pub(crate) async fn export_into(&self, request: ExportRequest, out: impl Write + Send + 'static) -> Answer<()> {
        let ExportRequest { run, encoding, channels: names, from_s, to_s, spreadsheet_safe } = request;
        let (meta, _) = self.export_facts(run).await?;
        let rows = self.inner.store.rows_between(run, from_s, to_s).await?;
        let names = names.as_deref();
        // The first row shows whether there are samples, before a client gets the begin of a file.
        let first = rows.start..rows.end.min(rows.start + 1);
        let channels = self.inner.store.trace(run, names, first).await?.channels().to_vec();
        match encoding {
            Encoding::File(FileFormat::Csv) => {
                let channels = if spreadsheet_safe { defused_channels(channels) } else { channels };
                let mut csv = CsvWriter::new(out, &channels);
                for stretch in stretches(&rows) {
                    csv.write(&self.inner.store.trace(run, names, stretch).await?).map_err(failed)?;
                }
                csv.finish().map_err(failed)
            }
            Encoding::File(FileFormat::Parquet) => {
                let mut parquet = ParquetWriter::new(out, &meta, &channels).map_err(failed)?;
                for stretch in stretches(&rows) {
                    parquet.write(&self.inner.store.trace(run, names, stretch).await?).map_err(failed)?;
                }
                parquet.finish().map_err(failed)
            }
            Encoding::ArrowStream => {
                let mut arrow = ArrowWriter::new(out, &meta, &channels).map_err(failed)?;
                for stretch in stretches(&rows) {
                    arrow.write(&self.inner.store.trace(run, names, stretch).await?).map_err(failed)?;
                }
                arrow.finish().map_err(failed)
            }
            Encoding::File(FileFormat::Mat) => {
                self.export_columns(run, rows, &channels, MatWriter::new(out), &meta).await
            }
        }
    }

    /// A MAT file stores one channel after the other.
    async fn export_columns(
        &self,
        run: i64,
        rows: Range<u64>,
        channels: &[Channel],
        mut mat: MatWriter<impl Write + Send>,
        meta: &Meta,
    ) -> Answer<()> {
        for channel in channels {
            mat.begin(&channel.name, (rows.end - rows.start) as usize).map_err(failed)?;
            for stretch in stretches(&rows) {
                let name = [channel.name.clone()];
                let column = self.inner.store.trace(run, Some(&name), stretch).await?;
                mat.values(&column.columns()[0]).map_err(failed)?;
            }
        }
        mat.finish(meta, channels).map_err(failed)
    }

    /// The metadata of a run for an export.
    pub(super) async fn export_facts(&self, id: i64) -> Answer<(Meta, RunRecord)> {
        let (mut meta, record) = self.facts(id).await?;
        if record.simulated {
            meta.other.insert(SIMULATED.to_owned(), true.into());
        }
        let tested =
            TestedUnit { unit: record.unit.clone(), operator: record.operator.clone(), ..TestedUnit::default() };
        tested.add_to(&mut meta)?;
        Ok((meta, record))
    }

    /// The metadata of a run as `meta.json`, for a table format without metadata.
    pub async fn export_meta(&self, id: i64) -> Answer<String> {
        let (meta, record) = self.export_facts(id).await?;
        Ok(meta_json(&meta, &record.channels))
    }
}

pub(super) fn stretches(rows: &Range<u64>) -> impl Iterator<Item = Range<u64>> + use<> {
    let end = rows.end;
    rows.clone().step_by(ROWS_AT_ONCE as usize).map(move |first| first..end.min(first + ROWS_AT_ONCE))
}

pub(super) fn failed(fault: io::Error) -> LabError {
    LabError::Internal(format!("writing the file failed: {fault}"))
}
