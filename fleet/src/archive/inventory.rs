//! All files of a table with their footers: each run once, damaged files named.

use super::footer::{self, Source};
use super::{Archive, Content};
use crate::Fault;
use datafusion::arrow::datatypes::SchemaRef;
use rayon::prelude::*;
use serde::Serialize;
use std::cmp::Reverse;
use std::collections::HashMap;
use std::path::PathBuf;

/// One file of the archive.
#[derive(Debug, Clone)]
pub struct ArchiveFile {
    /// Absolute path.
    pub path: PathBuf,
    /// Size in bytes.
    pub bytes: u64,
    /// Columns of the file.
    pub schema: SchemaRef,
    /// Its runs, in the order of the rows.
    pub sources: Vec<Source>,
    /// Whether `compact` has written it.
    pub is_compacted: bool,
}

/// A file that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Damaged {
    /// Its path.
    pub file: String,
    /// Why, in words.
    pub reason: String,
}

/// Which files are read.
#[derive(Debug, Clone, Default)]
pub struct Selection {
    /// Only runs of this part number.
    pub part: Option<String>,
    /// Omit damaged files instead of refusing.
    pub skip_damaged: bool,
    /// Files that were found to be damaged while they were read.
    pub omitted: Vec<Damaged>,
}

/// The files of a table of the archive. Each run occurs once.
#[derive(Debug, Clone)]
pub struct Inventory {
    /// Which table.
    pub content: Content,
    /// The files, by path.
    pub files: Vec<ArchiveFile>,
    /// Omitted files.
    pub damaged: Vec<Damaged>,
    /// Number of objects whose run is in another file with the same data. They are not read.
    pub duplicates: usize,
    /// Files of which all runs are such objects.
    pub duplicate_files: Vec<ArchiveFile>,
}

impl Inventory {
    /// Reads the footers of all files of a table.
    ///
    /// # Errors
    /// [`Fault::Input`] for a damaged or foreign file, unless these are omitted, and for two files with different data
    /// of one run.
    pub fn read(archive: &Archive, content: Content, selection: &Selection) -> Result<Self, Fault> {
        let paths = archive.files(content)?;
        let is_omitted = |path: &PathBuf| selection.omitted.iter().any(|one| one.file == path.display().to_string());
        let read: Vec<Result<ArchiveFile, Damaged>> =
            paths.into_par_iter().filter(|path| !is_omitted(path)).map(|path| file(path, content)).collect();
        let (mut files, mut damaged) = (Vec::new(), selection.omitted.clone());
        for found in read {
            match found {
                Ok(file) => files.push(file),
                Err(fault) if selection.skip_damaged => damaged.push(fault),
                Err(Damaged { file, reason }) => {
                    let remedy = "move it away, or omit it with --skip-damaged";
                    return Err(Fault::Input(format!("{file}: {reason}; {remedy}")));
                }
            }
        }
        let is_selected = |source: &Source| selection.part.is_none() || source.part() == selection.part.as_deref();
        files.retain(|file| file.sources.iter().any(is_selected));
        let (files, duplicate_files, duplicates) = once(files)?;
        Ok(Self { content, files, damaged, duplicates, duplicate_files })
    }

    /// All runs.
    pub fn sources(&self) -> impl Iterator<Item = &Source> {
        self.files.iter().flat_map(|file| &file.sources)
    }
}

fn file(path: PathBuf, content: Content) -> Result<ArchiveFile, Damaged> {
    let damaged = |reason: String| Damaged { file: path.display().to_string(), reason };
    let footer = footer::read(&path).map_err(&damaged)?;
    if footer.content != content.name() {
        return Err(damaged(format!("it contains {}, in the folder of {}", footer.content, content.name())));
    }
    let bytes = path.metadata().map_err(|fault| damaged(fault.to_string()))?.len();
    let footer::Footer { sources, schema, is_compacted, .. } = footer;
    Ok(ArchiveFile { path, bytes, schema, sources, is_compacted })
}

/// The files without those whose runs are in other files, these files, and the number of their runs. A file with more
/// runs is kept: it is the result of `compact`, which was interrupted before it removed the other files.
fn once(mut files: Vec<ArchiveFile>) -> Result<(Vec<ArchiveFile>, Vec<ArchiveFile>, usize), Fault> {
    files.sort_by_key(|file| Reverse(file.sources.len()));
    let mut seen: HashMap<(String, String), (String, PathBuf)> = HashMap::new();
    let (mut kept, mut repeated, mut count) = (Vec::new(), Vec::new(), 0);
    for file in files {
        let mut known = 0;
        for source in &file.sources {
            let Some((sha256, other)) = seen.get(&(source.store().to_owned(), source.run().to_owned())) else {
                continue;
            };
            if sha256 != source.sha256() {
                return Err(Fault::Input(format!(
                    "{} and {} have different data of run {} of store {}: move one of them away",
                    other.display(),
                    file.path.display(),
                    source.run(),
                    source.store()
                )));
            }
            known += 1;
        }
        count += known;
        match known {
            0 => {
                let key = |source: &Source| (source.store().to_owned(), source.run().to_owned());
                let value = |source: &Source| (source.sha256().to_owned(), file.path.clone());
                seen.extend(file.sources.iter().map(|source| (key(source), value(source))));
                kept.push(file);
            }
            known if known == file.sources.len() => repeated.push(file),
            known => {
                return Err(Fault::Input(format!(
                    "{}: {known} of its {} runs are also in other files: move it or these away",
                    file.path.display(),
                    file.sources.len()
                )));
            }
        }
    }
    kept.sort_by(|a, b| a.path.cmp(&b.path));
    Ok((kept, repeated, count))
}
