//! SQL over the archive.

use crate::Fault;
use crate::archive::{Archive, Damaged, Inventory, Selection, check};
use crate::session::{Session, session};
use datafusion::arrow::array::RecordBatch;
use datafusion::arrow::json::ArrayWriter;
use datafusion::arrow::util::pretty::pretty_format_batches;
use rayon::prelude::*;

/// A result with the session that computed it.
pub struct Answer {
    /// The rows, in batches.
    pub batches: Vec<RecordBatch>,
    /// Tables and files of the query.
    pub session: Session,
}

/// Runs one query on at most `threads` threads.
///
/// # Errors
/// [`Fault::Input`] for wrong SQL and for damaged files, which it names. With
/// [`Selection::skip_damaged`] these are omitted, and the query runs again without them.
pub fn answer(archive: &Archive, selection: &Selection, threads: usize, sql: &str) -> Result<Answer, Fault> {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(threads)
        .build()
        .map_err(|fault| Fault::Failed(format!("no threads: {fault}")))?;
    let mut selection = selection.clone();
    loop {
        let session = session(archive, &selection, threads)?;
        let run = async { session.context.sql(sql).await?.collect().await };
        let fault = match runtime.block_on(run) {
            Ok(batches) => return Ok(Answer { batches, session }),
            Err(fault) => Fault::from(fault),
        };
        // DataFusion does not name the file that it could not read.
        let damaged = match fault {
            Fault::Input(_) => Vec::new(),
            Fault::Failed(_) => unreadable([&session.means, &session.samples]),
        };
        match damaged.first() {
            None => return Err(fault),
            Some(_) if selection.skip_damaged => selection.omitted.extend(damaged),
            Some(first) => return Err(refusal(first)),
        }
    }
}

/// The refusal of a damaged file.
pub(crate) fn refusal(damaged: &Damaged) -> Fault {
    let Damaged { file, reason } = damaged;
    Fault::Input(format!("{file}: {reason}; move it away, or omit it with --skip-damaged"))
}

/// The files whose rows cannot be read.
pub(crate) fn unreadable<'i>(inventories: impl IntoIterator<Item = &'i Inventory>) -> Vec<Damaged> {
    let of = |inventory: &Inventory| {
        inventory.files.par_iter().filter_map(|file| check(file).err()).collect::<Vec<Damaged>>()
    };
    inventories.into_iter().flat_map(of).collect()
}

/// The rows as a table for people.
///
/// # Errors
/// [`Fault::Failed`] for a type that cannot be written.
pub fn text(batches: &[RecordBatch]) -> Result<String, Fault> {
    let table = pretty_format_batches(batches).map_err(|fault| Fault::Failed(fault.to_string()))?;
    Ok(format!("{table}\n"))
}

/// The rows as a JSON list of objects. An absent value is an absent key.
///
/// # Errors
/// [`Fault::Failed`] for a type that cannot be written.
pub fn json(batches: &[RecordBatch]) -> Result<String, Fault> {
    let fault = |fault: datafusion::arrow::error::ArrowError| Fault::Failed(fault.to_string());
    let mut writer = ArrayWriter::new(Vec::new());
    writer.write_batches(&batches.iter().collect::<Vec<&RecordBatch>>()).map_err(fault)?;
    writer.finish().map_err(fault)?;
    String::from_utf8(writer.into_inner()).map_err(|fault| Fault::Failed(fault.to_string()))
}
