//! The mark: a file that holds the number of the last durable change of the database.
//!
//! The mark is written after the commit and without waiting for the disk. It may be behind the database, never ahead: a
//! database with fewer changes than the mark has lost some. A mark that is incomplete or of another store is ignored.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, Write};
use std::path::Path;

const FILE_NAME: &str = "jointbench.mark";

/// `STORE CHANGES CHECKSUM`, always of the same length: overwriting needs no additional disk space.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mark {
    /// Identifier of the store.
    pub store: String,
    pub changes: i64,
}

impl Mark {
    /// `None` if there is no readable mark.
    pub fn read(folder: &Path) -> Option<Mark> {
        let mut text = String::new();
        File::open(folder.join(FILE_NAME)).ok()?.take(256).read_to_string(&mut text).ok()?;
        let mut words = text.split_whitespace();
        let mark = Mark { store: words.next()?.to_owned(), changes: words.next()?.parse().ok()? };
        (text == mark.text()).then_some(mark)
    }

    fn text(&self) -> String {
        let words = format!("{} {:020}", self.store, self.changes);
        format!("{words} {:08x}\n", crc32fast::hash(words.as_bytes()))
    }
}

/// The mark file of an open store.
#[derive(Debug)]
pub struct MarkFile(File);

impl MarkFile {
    pub fn open(folder: &Path) -> io::Result<Self> {
        let path = folder.join(FILE_NAME);
        Ok(Self(OpenOptions::new().write(true).create(true).truncate(false).open(path)?))
    }

    pub fn write(&mut self, mark: &Mark) -> io::Result<()> {
        self.0.rewind()?;
        self.0.write_all(mark.text().as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mark_is_read_back_and_a_torn_one_is_ignored() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(Mark::read(folder.path()), None);
        let mut file = MarkFile::open(folder.path()).unwrap();
        for changes in [9, 1_000_000, 12] {
            let mark = Mark { store: "00ff".into(), changes };
            file.write(&mark).unwrap();
            assert_eq!(Mark::read(folder.path()), Some(mark));
        }
        let path = folder.path().join(FILE_NAME);
        let torn = std::fs::read_to_string(&path).unwrap().replace("12 ", "13 ");
        std::fs::write(path, torn).unwrap();
        assert_eq!(Mark::read(folder.path()), None);
    }
}
