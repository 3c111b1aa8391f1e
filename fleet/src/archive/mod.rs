//! The archive of the daemon: its files, what their footers say, and their rows as run tables.

mod footer;
mod inventory;
mod rows;

pub(crate) use footer::SOURCES;
pub use footer::{CREATED_BY_COMPACTION, Source};
pub use inventory::{ArchiveFile, Damaged, Inventory, Selection};
pub use rows::{SourceTable, check, run_tables};

use crate::Fault;
use std::path::{Path, PathBuf};

/// A table of the archive, and the folder of its files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// One row for each steady state of a run.
    Means,
    /// All samples of a run.
    Samples,
}

impl Content {
    /// Name of the folder, of the table in SQL, and of the footer value.
    pub fn name(self) -> &'static str {
        match self {
            Content::Means => "means",
            Content::Samples => "samples",
        }
    }
}

/// An archive on a mounted file system.
#[derive(Debug, Clone)]
pub struct Archive {
    root: PathBuf,
}

impl Archive {
    /// Opens a folder: its path, or `file:///` and its absolute path.
    ///
    /// # Errors
    /// [`Fault::Input`] if it is no folder, or another kind of URL.
    pub fn open(url: &str) -> Result<Self, Fault> {
        let path = match url.split_once("://") {
            None => url,
            Some(("file", path)) if path.starts_with('/') => path,
            Some(("file", _)) => {
                return Err(Fault::Input(format!("{url}: expected file:/// and an absolute path")));
            }
            Some((scheme, _)) => {
                let remedy = "mount the storage and give its folder";
                return Err(Fault::Input(format!("{url}: this program reads folders, not {scheme}; {remedy}")));
            }
        };
        let root = std::path::absolute(path).map_err(|fault| Fault::Input(format!("{url}: {fault}")))?;
        if !root.is_dir() {
            let what = if root.exists() { "is no folder" } else { "does not exist" };
            return Err(Fault::Input(format!(
                "the archive {} {what}: give the folder of [archive] url",
                root.display()
            )));
        }
        Ok(Self { root })
    }

    /// Folder of the archive.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The complete files of a table, by name. Files without the ending `.parquet` are incomplete and not listed.
    ///
    /// # Errors
    /// [`Fault::Input`] if a folder cannot be read.
    pub fn files(&self, content: Content) -> Result<Vec<PathBuf>, Fault> {
        let mut open = vec![self.root.join(content.name())];
        let mut files = Vec::new();
        while let Some(folder) = open.pop().filter(|folder| folder.exists()) {
            let fault = |fault: std::io::Error| Fault::Input(format!("{}: {fault}", folder.display()));
            for entry in std::fs::read_dir(&folder).map_err(fault)? {
                let entry = entry.map_err(fault)?;
                let path = entry.path();
                if entry.file_type().map_err(fault)?.is_dir() {
                    open.push(path);
                } else if path.extension().is_some_and(|ending| ending == "parquet") {
                    files.push(path);
                }
            }
        }
        files.sort();
        Ok(files)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_archive_is_a_folder_or_its_url() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().display().to_string();
        assert_eq!(Archive::open(&path).unwrap().root(), folder.path());
        assert_eq!(Archive::open(&format!("file://{path}")).unwrap().root(), folder.path());
        for (wrong, why) in [("s3://fleet", "not s3"), ("file://a/b", "absolute"), ("/no/such", "does not exist")] {
            let fault = Archive::open(wrong).unwrap_err();
            assert!(fault.to_string().contains(why) && fault.exit_code() == 2, "{fault}");
        }
    }

    #[test]
    fn incomplete_files_are_not_listed() {
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("means/part=a/batch=b/bench=c");
        std::fs::create_dir_all(&inner).unwrap();
        for name in ["run-1-2.parquet", "run-1-1.parquet", "run-1-3.parquet.part#1"] {
            std::fs::write(inner.join(name), b"").unwrap();
        }
        let archive = Archive::open(&folder.path().display().to_string()).unwrap();
        let names: Vec<PathBuf> = archive.files(Content::Means).unwrap();
        assert_eq!(names, ["run-1-1.parquet", "run-1-2.parquet"].map(|name| inner.join(name)));
        assert!(archive.files(Content::Samples).unwrap().is_empty());
    }
}
