//! Names of files: Hive partitions by part, batch and bench.

use crate::config::ArchiveContent;
use percent_encoding::percent_encode_byte;

/// Hive's word for a missing value.
const ABSENT: &str = "__HIVE_DEFAULT_PARTITION__";

/// The partition of a run.
#[derive(Debug, Clone, Copy)]
pub struct Partition<'a> {
    pub part: Option<&'a str>,
    pub batch: Option<&'a str>,
    pub bench: &'a str,
}

/// The path of a table in the archive. Several stores may share an archive, because `store` is part of the name.
pub fn object_path(content: ArchiveContent, partition: Partition, store: &str, run: i64) -> String {
    let Partition { part, batch, bench } = partition;
    let value = |value: Option<&str>| value.map_or_else(|| ABSENT.to_owned(), encoded);
    let (part, batch, bench) = (value(part), value(batch), encoded(bench));
    let content = content.name();
    format!("{content}/part={part}/batch={batch}/bench={bench}/run-{store}-{run}.parquet")
}

/// ASCII characters that may have a meaning for a file system, or for a program that reads partitions, are encoded.
/// Other characters are kept: file names have at most 255 bytes.
fn encoded(value: &str) -> String {
    let encode = |c: char| match u8::try_from(c) {
        Ok(byte) if byte.is_ascii() && !c.is_ascii_alphanumeric() && !"-_.".contains(c) => {
            percent_encode_byte(byte).to_owned()
        }
        _ => c.to_string(),
    };
    value.chars().map(encode).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_has_the_partition_the_store_and_the_run() {
        let partition = Partition { part: Some("JT-100"), batch: None, bench: "joint-a" };
        assert_eq!(
            object_path(ArchiveContent::Means, partition, "00ff", 12),
            "means/part=JT-100/batch=__HIVE_DEFAULT_PARTITION__/bench=joint-a/run-00ff-12.parquet"
        );
    }

    #[test]
    fn no_value_leads_to_another_folder() {
        let partition = Partition { part: Some("../a=b %"), batch: Some("Größe 7/8"), bench: "b" };
        let path = object_path(ArchiveContent::Samples, partition, "00ff", 12);
        assert_eq!(path, "samples/part=..%2Fa%3Db%20%25/batch=Größe%207%2F8/bench=b/run-00ff-12.parquet");
        assert!(object_store::path::Path::parse(&path).is_ok());
    }
}
