//! Files that commands read and write.

use super::exit::{Done, Exit};
use jointbench_files::FileFault;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Names of a run table in its own folder.
const TABLES: [&str; 4] = ["run.csv", "run.csv.gz", "run.parquet", "run.arrow"];

/// The table of a run: the named file, or the one in the named folder.
pub fn table(named: &Path) -> Result<PathBuf, Exit> {
    if !named.is_dir() {
        return Ok(named.to_owned());
    }
    let there = TABLES.map(|name| named.join(name)).into_iter().filter(|path| path.is_file());
    match there.collect::<Vec<_>>().as_slice() {
        [table] => Ok(table.clone()),
        [] => Err(Exit::bad_input(format!(
            "{} is a folder without {}: give the file of the run",
            named.display(),
            TABLES.join(", ")
        ))),
        [first, second, ..] => {
            Err(Exit::bad_input(format!("{} and {} both exist: give one of them", first.display(), second.display())))
        }
    }
}

/// Refuses an impossible output path before the work starts.
pub fn writable(path: &Path) -> Done {
    if path.is_dir() {
        let folder = path.display();
        return Err(Exit::bad_input(format!("{folder} is a folder: give the file to write")));
    }
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.is_dir()) {
        let (path, folder) = (path.display(), folder.display());
        return Err(Exit::bad_input(format!("{path} cannot be written: folder {folder} does not exist")));
    }
    Ok(())
}

pub fn read(path: &Path) -> Result<Vec<u8>, Exit> {
    fs::read(path).map_err(|fault| unread(path, fault))
}

/// Largest file that a person writes [bytes].
const SHORT: u64 = 1 << 20;

/// The text of a file that a person has written.
pub fn read_short_text(path: &Path) -> Result<String, Exit> {
    let mut text = String::new();
    let file = fs::File::open(path).map_err(|fault| unread(path, fault))?;
    file.take(SHORT + 1).read_to_string(&mut text).map_err(|fault| unread(path, fault))?;
    match text.len() as u64 > SHORT {
        true => Err(Exit::bad_input(format!("{}: longer than 1 MiB", path.display()))),
        false => Ok(text),
    }
}

pub fn read_text(path: &Path) -> Result<String, Exit> {
    fs::read_to_string(path).map_err(|fault| unread(path, fault))
}

fn unread(path: &Path, fault: io::Error) -> Exit {
    Exit::bad_input(format!("{}: {}", path.display(), FileFault::Io(fault)))
}

pub fn write(path: &Path, bytes: &[u8]) -> Done {
    writable(path)?;
    fs::write(path, bytes).map_err(|fault| Exit::bad_input(format!("{}: {fault}", path.display())))
}
