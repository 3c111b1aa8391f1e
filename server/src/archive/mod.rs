//! One file in the archive: its name, its digest, and how it is written so that it is complete or absent.
//!
//! Only a separate process (`jointbench job`) uses this module: an archive that does not answer blocks no thread of the
//! daemon.

mod bucket;
mod digest;
mod fault;
mod path;

pub use digest::Digest;
pub use path::{Partition, object_path};

use crate::config::S3;
use crate::error::LabError;
use fault::unavailable;
use object_store::local::LocalFileSystem;
use object_store::path::Path;
use object_store::{Error, GetResultPayload, MultipartUpload, ObjectStore, ObjectStoreExt as _};
use std::fs::File;
use std::io::Write;
use std::path::PathBuf;

/// S3 accepts parts of at least 5 MiB.
const PART_BYTES: usize = 5 << 20;

/// An open archive.
pub struct Archive {
    folder: String,
    files: Box<dyn ObjectStore>,
}

/// A file before it has its name.
pub struct Upload<'a> {
    archive: &'a Archive,
    path: Path,
    staged: Path,
    parts: Box<dyn MultipartUpload>,
    /// Bytes of the next part.
    buffer: Vec<u8>,
}

impl Archive {
    /// # Errors
    /// [`LabError::Busy`]: a later attempt may succeed, as with all errors of this module.
    pub fn open(folder: &str) -> Result<Self, LabError> {
        let files: Box<dyn ObjectStore> = match folder.strip_prefix(S3) {
            Some(address) => bucket::open(address)?,
            None => {
                let path = std::path::Path::new(folder);
                if !path.is_dir() {
                    let what = if path.exists() { "is no folder" } else { "does not exist" };
                    let remedy = "create the folder, or mount its file system";
                    return Err(LabError::Busy(format!("the archive {folder} {what}: {remedy}")));
                }
                Box::new(LocalFileSystem::new_with_prefix(path).map_err(|fault| unavailable(folder, &fault))?)
            }
        };
        Ok(Self { folder: folder.to_owned(), files })
    }

    /// A file with its size. `None` if it does not exist.
    pub async fn find(&self, path: &str) -> Result<Option<(File, u64)>, LabError> {
        let path = self.path(path)?;
        let found = match self.files.get(&path).await {
            Err(Error::NotFound { .. }) => return Ok(None),
            found => found.map_err(|fault| self.fault(&fault))?,
        };
        let bytes = found.meta.size;
        match found.payload {
            GetResultPayload::File(file, _) => Ok(Some((file, bytes))),
            GetResultPayload::Stream(_) => Ok(Some((self.download(&path, bytes).await?, bytes))),
        }
    }

    /// A temporary copy. Each request has a part of the file, because requests have a time limit.
    async fn download(&self, path: &Path, bytes: u64) -> Result<File, LabError> {
        let unwritable = |fault| LabError::Busy(format!("no temporary copy of {path}: {fault}"));
        // Not in the data folder: the copy must not fill the disk of the recorder.
        let mut copy = tempfile::tempfile().map_err(unwritable)?;
        for start in (0..bytes).step_by(PART_BYTES) {
            let range = start..bytes.min(start + PART_BYTES as u64);
            let part = self.files.get_range(path, range).await.map_err(|fault| self.fault(&fault))?;
            copy.write_all(&part).map_err(unwritable)?;
        }
        Ok(copy)
    }

    /// Begins a file. It gets its name at the end.
    pub async fn begin(&self, path: &str) -> Result<Upload<'_>, LabError> {
        let (path, staged) = (self.path(path)?, self.path(&format!("{path}.part"))?);
        self.remove_interrupted(&staged);
        let parts = self.files.put_multipart(&staged).await.map_err(|fault| self.fault(&fault))?;
        Ok(Upload { archive: self, path, staged, parts, buffer: Vec::new() })
    }

    /// A process that was ended in the middle of an upload has left its incomplete file `*.part#1`.
    fn remove_interrupted(&self, staged: &Path) {
        let Some(file) = self.local(staged) else { return };
        let interrupted = |number: u32| std::fs::remove_file(format!("{}#{number}", file.display()));
        let mut number = 1;
        while interrupted(number).is_ok() {
            number += 1;
        }
    }

    /// Path in a folder; `None` in a bucket.
    fn local(&self, path: &Path) -> Option<PathBuf> {
        (!self.folder.starts_with(S3)).then(|| std::path::Path::new(&self.folder).join(path.as_ref()))
    }

    fn path(&self, path: &str) -> Result<Path, LabError> {
        Path::parse(path).map_err(|fault| self.fault(&fault))
    }

    fn fault(&self, fault: &dyn std::error::Error) -> LabError {
        unavailable(&self.folder, fault)
    }
}

impl Upload<'_> {
    pub async fn write(&mut self, bytes: Vec<u8>) -> Result<(), LabError> {
        self.buffer.extend(bytes);
        while self.buffer.len() >= PART_BYTES {
            let part = self.buffer.drain(..PART_BYTES).collect();
            self.put(part).await?;
        }
        Ok(())
    }

    /// Writes the last part.
    pub async fn flush(&mut self) -> Result<(), LabError> {
        let part = std::mem::take(&mut self.buffer);
        self.put(part).await
    }

    async fn put(&mut self, part: Vec<u8>) -> Result<(), LabError> {
        self.parts.put_part(part.into()).await.map_err(|fault| self.archive.fault(&fault))
    }

    /// The file gets its name, unless another file has it. Returns whether it did.
    pub async fn finish(mut self) -> Result<bool, LabError> {
        let Upload { archive, path, staged, parts, .. } = &mut self;
        parts.complete().await.map_err(|fault| archive.fault(&fault))?;
        if let Some(file) = archive.local(staged) {
            // The name must not reach the disk before the content.
            File::open(file).and_then(|file| file.sync_all()).map_err(|fault| archive.fault(&fault))?;
        }
        match archive.files.rename_if_not_exists(staged, path).await {
            Err(Error::AlreadyExists { .. }) => {
                archive.files.delete(staged).await.map_err(|fault| archive.fault(&fault))?;
                Ok(false)
            }
            renamed => renamed.map(|()| true).map_err(|fault| archive.fault(&fault)),
        }
    }

    /// Removes the incomplete file.
    pub async fn abort(mut self) {
        if let Err(fault) = self.parts.abort().await {
            tracing::warn!(%fault, "an incomplete file remains in the archive");
        }
    }
}
