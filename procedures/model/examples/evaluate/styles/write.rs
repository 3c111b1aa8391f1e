//! Writes cases as folders: `run.csv.gz`, `meta.json`, `answer.json`.

use super::Case;
use flate2::Compression;
use flate2::write::GzEncoder;
use std::error::Error;
use std::fs::{File, create_dir_all, write};
use std::io::{BufWriter, Write};
use std::path::Path;

pub fn folder(case: &Case, into: &Path) -> Result<(), Box<dyn Error>> {
    let folder = into.join(&case.name);
    create_dir_all(&folder)?;
    write(folder.join("meta.json"), serde_json::to_string_pretty(case.run.meta())?)?;
    write(folder.join("answer.json"), serde_json::to_string_pretty(&case.answer)?)?;
    let file = BufWriter::new(File::create(folder.join("run.csv.gz"))?);
    let mut file = GzEncoder::new(file, Compression::fast());
    let names: Vec<&str> = case.run.trace().channels().iter().map(|c| c.name.as_str()).collect();
    let columns: Vec<&[f64]> = names.iter().filter_map(|name| case.run.column(name)).collect();
    writeln!(file, "{}", names.join(","))?;
    for row in 0..case.run.len() {
        let fields: Vec<String> = columns.iter().map(|c| c[row].to_string()).collect();
        writeln!(file, "{}", fields.join(","))?;
    }
    file.finish()?.flush()?;
    Ok(())
}
