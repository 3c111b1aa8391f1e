//! The archive: a folder for the tables of ended runs.

use super::error::Collector;
use super::raw::RawArchive;
use percent_encoding::percent_decode_str;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
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
    pub folder: PathBuf,
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

pub fn check_archive(raw: &RawArchive, wrong: &mut Collector) -> Option<Archive> {
    let url = raw.url.get_ref().trim();
    let fault = match url.split_once("://") {
        None => FORM.to_owned(),
        Some(("file", path)) => match folder(path) {
            Some(folder) => return Some(Archive { url: url.to_owned(), folder, raw: raw.raw }),
            None => FORM.to_owned(),
        },
        Some((scheme, _)) => format!("an archive at {scheme}:// is not supported: {FORM} (a mounted file system)"),
    };
    wrong.add(raw.url.span(), format!("archive.url {url:?}: {fault}"));
    None
}

/// The path of an address without its scheme. `None` if it names a host, or no folder.
fn folder(path: &str) -> Option<PathBuf> {
    let path = percent_decode_str(path).decode_utf8().ok()?;
    // file:///C:/archive
    let has_drive = cfg!(windows) && path.as_bytes().get(2) == Some(&b':');
    let path = Path::new(if has_drive { path.strip_prefix('/')? } else { &path });
    (path.is_absolute() && path.parent().is_some()).then(|| path.to_owned())
}
