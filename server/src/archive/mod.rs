//! One file in the archive: its name, its digest, and how it is written so that it is complete or absent.
//!
//! Only a separate process (`jointbench job`) uses this module: an archive that does not answer blocks no thread of the
//! daemon.

mod digest;
mod path;

pub use digest::Digest;
pub use path::{Partition, object_path};

use crate::error::LabError;
use object_store::local::LocalFileSystem;
use object_store::path::Path;
use object_store::{Error, GetResultPayload, MultipartUpload, ObjectStoreExt as _};
use std::fs::File;
use std::path::PathBuf;

/// An open archive.
pub struct Archive {
    folder: PathBuf,
    files: LocalFileSystem,
}

/// A file before it has its name.
pub struct Upload<'a> {
    archive: &'a Archive,
    path: Path,
    staged: Path,
    parts: Box<dyn MultipartUpload>,
}

impl Archive {
    /// # Errors
    /// [`LabError::Busy`]: a later attempt may succeed, as with all errors of this module.
    pub fn open(folder: PathBuf) -> Result<Self, LabError> {
        if !folder.is_dir() {
            let what = if folder.exists() { "is no folder" } else { "does not exist" };
            let remedy = "create the folder, or mount its file system";
            return Err(LabError::Busy(format!("the archive {} {what}: {remedy}", folder.display())));
        }
        let files = LocalFileSystem::new_with_prefix(&folder).map_err(|fault| unavailable(&folder, &fault))?;
        Ok(Self { folder, files })
    }

    /// A file with its size. `None` if it does not exist.
    pub async fn find(&self, path: &str) -> Result<Option<(File, u64)>, LabError> {
        let found = match self.files.get(&self.path(path)?).await {
            Err(Error::NotFound { .. }) => return Ok(None),
            found => found.map_err(|fault| self.fault(&fault))?,
        };
        let bytes = found.meta.size;
        match found.payload {
            GetResultPayload::File(file, _) => Ok(Some((file, bytes))),
            GetResultPayload::Stream(_) => Err(LabError::Internal("the archive is no file system".to_owned())),
        }
    }

    /// Begins a file. It gets its name at the end.
    pub async fn begin(&self, path: &str) -> Result<Upload<'_>, LabError> {
        let (path, staged) = (self.path(path)?, self.path(&format!("{path}.part"))?);
        self.remove_interrupted(&staged)?;
        let parts = self.files.put_multipart(&staged).await.map_err(|fault| self.fault(&fault))?;
        Ok(Upload { archive: self, path, staged, parts })
    }

    /// A process that was ended in the middle of an upload has left its incomplete file `*.part#1`.
    fn remove_interrupted(&self, staged: &Path) -> Result<(), LabError> {
        let file = self.files.path_to_filesystem(staged).map_err(|fault| self.fault(&fault))?;
        let interrupted = |number: u32| std::fs::remove_file(format!("{}#{number}", file.display()));
        let mut number = 1;
        while interrupted(number).is_ok() {
            number += 1;
        }
        Ok(())
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
        if bytes.is_empty() {
            return Ok(());
        }
        self.parts.put_part(bytes.into()).await.map_err(|fault| self.archive.fault(&fault))
    }

    /// The file gets its name, unless another file has it. Returns whether it did.
    pub async fn finish(mut self) -> Result<bool, LabError> {
        let Upload { archive, path, staged, parts } = &mut self;
        parts.complete().await.map_err(|fault| archive.fault(&fault))?;
        let file = archive.files.path_to_filesystem(staged).map_err(|fault| archive.fault(&fault))?;
        // The name must not reach the disk before the content.
        File::open(file).and_then(|file| file.sync_all()).map_err(|fault| archive.fault(&fault))?;
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

/// The fault with its cause: `object_store` names only the operation.
fn unavailable(folder: &std::path::Path, fault: &dyn std::error::Error) -> LabError {
    let mut text = format!("the archive {} is not available: {fault}", folder.display());
    let mut cause = fault.source();
    while let Some(fault) = cause {
        let why = fault.to_string();
        if !text.contains(&why) {
            text += &format!(": {why}");
        }
        cause = fault.source();
    }
    LabError::Busy(text)
}
