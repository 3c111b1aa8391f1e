//! What the footer of a file says about its runs.

use datafusion::arrow::datatypes::SchemaRef;
use datafusion::parquet::arrow::arrow_reader::{ArrowReaderMetadata, ArrowReaderOptions};
use jointbench_instrument::Meta;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::File;
use std::panic::catch_unwind;
use std::path::Path;

/// Version of the layout in docs/archive.md.
const SCHEMA_VERSION: &str = "1";
/// Before the names of all facts in the footer of the daemon.
const PREFIX: &str = "jointbench.";
/// Key of the test conditions.
const META: &str = "meta";
/// Key of the runs of a file that `compact` has written: a JSON list of [`Source`].
pub(crate) const SOURCES: &str = "jointbench.sources";
/// Value of `jointbench.written_by` in files of `compact`.
pub const CREATED_BY_COMPACTION: &str = "jointbench-fleet compact";

/// One run in a file of the archive.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Source {
    /// Facts of the footer without their prefix `jointbench.`: `store`, `run`, `serial`, `sha256` and so on.
    pub facts: BTreeMap<String, String>,
    /// Test conditions as JSON.
    pub meta: String,
    /// Number of rows. In a file with several runs the rows of one run follow each other, in the order of the list.
    pub rows: usize,
}

impl Source {
    fn fact(&self, name: &str) -> Option<&str> {
        self.facts.get(name).map(String::as_str)
    }

    /// A fact that each file has; empty if it is absent.
    fn known(&self, name: &str) -> &str {
        self.fact(name).unwrap_or_default()
    }

    /// Id of the store of the daemon.
    pub fn store(&self) -> &str {
        self.known("store")
    }

    /// Number of the run in its store.
    pub fn run(&self) -> &str {
        self.known("run")
    }

    /// Serial number of the unit under test.
    pub fn serial(&self) -> Option<&str> {
        self.fact("serial")
    }

    /// Part number of the unit.
    pub fn part(&self) -> Option<&str> {
        self.fact("part")
    }

    /// Revision of the part.
    pub fn revision(&self) -> Option<&str> {
        self.fact("revision")
    }

    /// Production batch of the unit.
    pub fn batch(&self) -> Option<&str> {
        self.fact("batch")
    }

    /// Name of the bench.
    pub fn bench(&self) -> &str {
        self.known("bench")
    }

    /// Name of the procedure.
    pub fn procedure(&self) -> &str {
        self.known("procedure")
    }

    /// State in which the run ended.
    pub fn state(&self) -> &str {
        self.known("state")
    }

    /// Time at which the run was created, RFC 3339.
    pub fn created_at(&self) -> &str {
        self.known("created_at")
    }

    /// SHA-256 of the columns of doubles.
    pub fn sha256(&self) -> &str {
        self.known("sha256")
    }

    /// Test conditions of the run.
    ///
    /// # Errors
    /// The position of wrong JSON.
    pub fn conditions(&self) -> Result<Meta, String> {
        serde_json::from_str(&self.meta).map_err(|fault| format!("the test conditions in the footer: {fault}"))
    }
}

/// A file's footer: the runs in it, and its columns.
pub(super) struct Footer {
    pub content: String,
    pub sources: Vec<Source>,
    pub schema: SchemaRef,
    /// Whether `compact` has written the file.
    pub is_compacted: bool,
}

/// Reads the footer of a file.
///
/// # Errors
/// Why the file is no file of the archive, in words.
pub(super) fn read(path: &Path) -> Result<Footer, String> {
    // The decoders panic on some broken files.
    catch_unwind(|| decode(path)).unwrap_or_else(|_| Err("its parts contradict each other".to_owned()))
}

fn decode(path: &Path) -> Result<Footer, String> {
    let file = File::open(path).map_err(|fault| fault.to_string())?;
    let metadata = ArrowReaderMetadata::load(&file, ArrowReaderOptions::new())
        .map_err(|fault| format!("no complete Parquet file ({fault})"))?;
    let keys = metadata.metadata().file_metadata().key_value_metadata().into_iter().flatten();
    let mut facts: BTreeMap<String, String> =
        keys.filter_map(|pair| Some((pair.key.clone(), pair.value.clone()?))).collect();
    // The daemon embeds the test conditions in the schema.
    let schema = metadata.schema().clone();
    facts.extend(schema.metadata().iter().map(|(key, value)| (key.clone(), value.clone())));
    match facts.get("jointbench.schema_version").map(String::as_str) {
        Some(SCHEMA_VERSION) => {}
        Some(other) => return Err(format!("its layout has version {other}, this program reads {SCHEMA_VERSION}")),
        None => return Err("no file of jointbench: its footer has no jointbench.schema_version".to_owned()),
    }
    let content = facts.get("jointbench.content").cloned().unwrap_or_default();
    let rows = metadata.metadata().file_metadata().num_rows().max(0) as usize;
    let listed = facts.get(SOURCES);
    let is_compacted = listed.is_some();
    let sources = match listed {
        Some(list) => serde_json::from_str(list).map_err(|fault| format!("its list of runs: {fault}"))?,
        None => vec![single(facts, rows)],
    };
    check(&sources, rows)?;
    Ok(Footer { content, sources, schema, is_compacted })
}

fn single(facts: BTreeMap<String, String>, rows: usize) -> Source {
    let meta = facts.get(META).cloned().unwrap_or_else(|| "{}".to_owned());
    let own = facts.into_iter().filter_map(|(key, value)| Some((key.strip_prefix(PREFIX)?.to_owned(), value)));
    Source { facts: own.collect(), meta, rows }
}

/// Every run can be identified, and the runs have all rows.
fn check(sources: &[Source], rows: usize) -> Result<(), String> {
    if let Some(nameless) = sources.iter().find(|source| source.store().is_empty() || source.run().is_empty()) {
        return Err(format!("its footer names no store or no run (bench {})", nameless.bench()));
    }
    match sources.iter().map(|source| source.rows).sum::<usize>() {
        listed if listed == rows => Ok(()),
        listed => Err(format!("it has {rows} rows, its list of runs has {listed}")),
    }
}
