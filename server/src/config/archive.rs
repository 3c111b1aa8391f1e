//! The archive: a folder or a bucket for the tables of ended runs.

use super::error::Collector;
use super::raw::RawArchive;
use percent_encoding::percent_decode_str;
use serde::{Deserialize, Serialize};
use std::path::Path;
use utoipa::ToSchema;

/// A table of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ArchiveContent {
    /// The mean of each channel over each steady state.
    Means,
    /// All samples.
    Samples,
}

impl ArchiveContent {
    /// Word of the store, and folder of the archive.
    pub fn name(self) -> &'static str {
        match self {
            ArchiveContent::Means => "means",
            ArchiveContent::Samples => "samples",
        }
    }
}

/// The archive of a bench description.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Archive {
    /// As in the description.
    pub url: String,
    /// Path of a folder, or `s3://BUCKET/PREFIX`.
    pub folder: String,
    /// The samples too.
    pub raw: bool,
}

impl Archive {
    pub fn contents(&self) -> &'static [ArchiveContent] {
        match self.raw {
            true => &[ArchiveContent::Means, ArchiveContent::Samples],
            false => &[ArchiveContent::Means],
        }
    }
}

const FORM: &str = "write file:// and an absolute path, such as file:///srv/jointbench";

pub const S3: &str = "s3://";
const S3_FORM: &str = "write s3://BUCKET or s3://BUCKET/PREFIX. Keys are set in the environment (AWS_ACCESS_KEY_ID, \
    AWS_SECRET_ACCESS_KEY)";
pub const NO_S3: &str = "this build of jointbench has no object storage: build it with `--features s3`";

pub fn check_archive(raw: &RawArchive, wrong: &mut Collector) -> Option<Archive> {
    let url = raw.url.get_ref().trim();
    match folder(url) {
        Ok(folder) => return Some(Archive { url: url.to_owned(), folder, raw: raw.raw }),
        Err(fault) => wrong.add(raw.url.span(), format!("archive.url{fault}")),
    }
    None
}

/// The folder of a URL. The fault does not repeat a URL that may contain a key.
fn folder(url: &str) -> Result<String, String> {
    match url.split_once("://") {
        Some(("file", path)) => local_folder(path).ok_or_else(|| format!(" {url:?}: {FORM}")),
        Some(("s3", address)) if !is_bucket(address) => Err(format!(": {S3_FORM}")),
        Some(("s3", _)) if !cfg!(feature = "s3") => Err(format!(" {url:?}: {NO_S3}")),
        Some(("s3", _)) => Ok(url.to_owned()),
        Some((scheme, _)) => {
            Err(format!(": an archive at {scheme}:// is not supported: {FORM} (a mounted file system)"))
        }
        None => Err(format!(" {url:?}: {FORM}")),
    }
}

/// A bucket, or a bucket and a prefix.
fn is_bucket(address: &str) -> bool {
    let is_name = |name: &str| {
        let known = |c: char| c.is_ascii_alphanumeric() || "-_.=".contains(c);
        !matches!(name, "" | "." | "..") && name.chars().all(known)
    };
    address.split('/').all(is_name)
}

/// The path of an address without its scheme. `None` if it names a host, or no folder.
fn local_folder(path: &str) -> Option<String> {
    let path = percent_decode_str(path).decode_utf8().ok()?;
    // file:///C:/archive
    let has_drive = cfg!(windows) && path.as_bytes().get(2) == Some(&b':');
    let path = Path::new(if has_drive { path.strip_prefix('/')? } else { &path });
    (path.is_absolute() && path.parent().is_some()).then(|| path.display().to_string())
}
