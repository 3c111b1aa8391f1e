//! Reads measured runs from next to the repository, and simulates others.

#![allow(dead_code, reason = "each test binary uses its part")]

pub mod bench;
pub mod controller;
pub mod recordings;
pub mod tables;

use jointbench_instrument::{Channel, Meta, RunTable, Trace};
use std::io::Read;
use std::path::{Path, PathBuf};

/// A folder of runs; `None` with a message if it is missing.
pub fn shared(folder: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared").join(folder);
    if path.is_dir() {
        return Some(path);
    }
    println!("skipped: {} is not there", path.display());
    None
}

pub fn read(folder: &Path) -> RunTable {
    let meta: Meta = serde_json::from_str(&std::fs::read_to_string(folder.join("meta.json")).unwrap()).unwrap();
    let mut text = Vec::new();
    match std::fs::File::open(folder.join("run.csv.gz")) {
        Ok(file) => flate2::read::GzDecoder::new(file).read_to_end(&mut text).unwrap(),
        Err(_) => std::fs::File::open(folder.join("run.csv")).unwrap().read_to_end(&mut text).unwrap(),
    };
    let mut reader = csv::Reader::from_reader(text.as_slice());
    let channels: Vec<Channel> = reader.headers().unwrap().iter().map(Channel::new).collect();
    let mut columns = vec![Vec::new(); channels.len()];
    for record in reader.into_records() {
        for (column, field) in columns.iter_mut().zip(record.unwrap().iter()) {
            column.push(field.parse().unwrap());
        }
    }
    RunTable::new(meta, Trace::from_columns(channels, columns)).unwrap()
}
