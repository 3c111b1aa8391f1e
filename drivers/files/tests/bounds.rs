//! A table beyond a bound is refused by the name of the bound, before it fills the memory.

use arrow_array::{ArrayRef, DictionaryArray, Float64Array, Int64Array, RecordBatch, StringArray, types::Int32Type};
use arrow_ipc::CompressionType;
use arrow_ipc::writer::{FileWriter, IpcWriteOptions};
use flate2::Compression;
use flate2::write::GzEncoder;
use jointbench_files::{Bounds, ReadOptions, read_bytes, write_parquet};
use jointbench_instrument::{Channel, Kind, Meta, Trace};
use std::io::Write;
use std::sync::Arc;

const SMALL: Bounds = Bounds { rows: 100, columns: 4, expanded_bytes: 1 << 20, cell_bytes: 64, name_bytes: 32 };
const HEAD: &str = "time_s,motor_position_rad,motor_current_a\n";

fn options(bounds: Bounds) -> ReadOptions {
    ReadOptions { meta: Some(facts()), bounds, ..ReadOptions::default() }
}

fn facts() -> Meta {
    Meta { kind: Some(Kind::Friction), ..Meta::default() }
}

fn refused(name: &str, bytes: &[u8]) -> String {
    read_bytes(name, bytes, &options(SMALL)).expect_err("it is beyond a bound").to_string()
}

fn rows(count: usize) -> String {
    (0..count).fold(HEAD.to_owned(), |table, row| table + &format!("{row},0,1\n"))
}

fn gzipped(text: &[u8]) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    packed.write_all(text).unwrap();
    packed.finish().unwrap()
}

#[test]
fn a_csv_has_bounds() {
    read_bytes("run.csv", rows(100).as_bytes(), &options(SMALL)).unwrap();
    let message = refused("run.csv", rows(101).as_bytes());
    assert!(message.contains("line 102") && message.contains("more than 100 rows: split the file"), "{message}");
    let message = refused("run.csv", b"a,b,c,d,e\n1,2,3,4,5\n");
    assert!(message.contains("5 columns: at most 4 are read"), "{message}");
    let message = refused("run.csv", format!("time_s,{}\n0,0\n", "x".repeat(40)).as_bytes());
    assert!(message.contains("“xxxxxxxxxxxxxxxxxxxx…” has 40 bytes: at most 32"), "{message}");
    let message = refused("run.csv", format!("{HEAD}0,\"{}\",1\n", "9".repeat(70)).as_bytes());
    assert!(message.contains("line 2, column motor_position_rad: a cell of 70 bytes"), "{message}");
}

#[test]
fn what_is_packed_is_not_unpacked_without_end() {
    read_bytes("run.csv.gz", &gzipped(rows(9).as_bytes()), &options(SMALL)).unwrap();
    let message = refused("run.csv.gz", &gzipped(&vec![b'0'; 20 << 20]));
    assert!(message.contains("it unpacks to more than 1 MiB: split the file, leave columns out"), "{message}");
    // Within the absolute bound of an upload, but a useless table.
    let bomb = gzipped(&vec![b'0'; 257 << 20]);
    let message = read_bytes("run.csv.gz", &bomb, &options(Bounds::UPLOADED)).unwrap_err().to_string();
    assert!(message.contains("more than 200 times its size"), "{message}");
}

#[test]
fn a_parquet_file_has_bounds() {
    let run = |rows: u32, columns: usize| {
        let column = |start: u32| (0..rows).map(|row| f64::from(start + row)).collect::<Vec<f64>>();
        let names = HEAD.trim().split(',').map(Channel::new).chain((0..).map(|n| Channel::new(format!("x{n}"))));
        let trace = Trace::from_columns(names.take(columns).collect(), vec![column(0); columns]);
        let mut bytes = Vec::new();
        write_parquet(&mut bytes, &facts(), &trace).unwrap();
        bytes
    };
    read_bytes("run.parquet", &run(100, 3), &options(SMALL)).unwrap();
    let message = refused("run.parquet", &run(101, 3));
    assert!(message.contains("more than 100 rows"), "{message}");
    let message = refused("run.parquet", &run(9, 5));
    assert!(message.contains("5 columns: at most 4"), "{message}");
}

fn arrow(columns: Vec<(&str, ArrayRef)>, compression: Option<CompressionType>) -> Vec<u8> {
    let batch = RecordBatch::try_from_iter(columns).unwrap();
    let options = IpcWriteOptions::default().try_with_compression(compression).unwrap();
    let mut bytes = Vec::new();
    let mut writer = FileWriter::try_new_with_options(&mut bytes, &batch.schema(), options).unwrap();
    writer.write(&batch).unwrap();
    writer.finish().unwrap();
    drop(writer);
    bytes
}

fn numbers(rows: u32) -> ArrayRef {
    Arc::new(Float64Array::from_iter_values((0..rows).map(f64::from)))
}

fn run(rows: u32, compression: Option<CompressionType>) -> Vec<u8> {
    let current: ArrayRef = Arc::new(Int64Array::from_iter_values(0..i64::from(rows)));
    let columns =
        [("time_s", numbers(rows)), ("motor_position_rad", numbers(rows)), ("motor_current_a", current)].to_vec();
    arrow(columns, compression)
}

#[test]
fn an_arrow_file_has_bounds() {
    for compression in [None, Some(CompressionType::LZ4_FRAME), Some(CompressionType::ZSTD)] {
        let table = read_bytes("run.arrow", &run(100, compression), &options(SMALL)).unwrap();
        assert_eq!(table.column("motor_current_a").unwrap()[99], 99.0);
        let message = refused("run.arrow", &run(101, compression));
        assert!(message.contains("more than 100 rows"), "{message}");
    }
    let wide = ["a", "b", "c", "d", "e"].map(|name| (name, numbers(3))).to_vec();
    assert!(refused("run.arrow", &arrow(wide, None)).contains("5 columns"));
}

/// The stated unpacked length of a buffer may have any value.
#[test]
fn an_arrow_file_with_a_false_size_is_rejected() {
    let file = run(90, Some(CompressionType::ZSTD));
    let length = (90_u64 * 8).to_le_bytes();
    let at = file.windows(8).position(|bytes| bytes == length).unwrap();
    for (claimed, why) in [(1_i64 << 40, "it unpacks to more than 1 MiB"), (-2, "does not fit the file")] {
        let mut lies = file.clone();
        lies[at..at + 8].copy_from_slice(&claimed.to_le_bytes());
        let message = refused("run.arrow", &lies);
        assert!(message.contains(why), "{claimed}: {message}");
    }
}

/// A dictionary of repeated long words is small in a file and large in memory; its type alone determines the refusal.
#[test]
fn words_are_left_before_they_are_unpacked() {
    let words: ArrayRef = Arc::new(StringArray::from_iter_values((0..9).map(|_| "x".repeat(100))));
    let dictionary: ArrayRef = Arc::new(DictionaryArray::<Int32Type>::from_iter((0..9).map(|_| "cold")));
    for (column, found) in [(words, "Utf8"), (dictionary, "Dictionary")] {
        let columns = [("time_s", numbers(9)), ("motor_position_rad", numbers(9)), ("motor_current_a", numbers(9))];
        let columns = columns.into_iter().chain([("remark", column)]).collect();
        let file = arrow(columns, None);
        let table = read_bytes("run.arrow", &file, &options(SMALL)).unwrap();
        assert_eq!((table.len(), table.column("remark")), (9, None), "nobody needs it");
        let needed = ReadOptions { map: vec![("temperature_c".into(), "remark".into())], ..options(SMALL) };
        let message = read_bytes("run.arrow", &file, &needed).unwrap_err().to_string();
        assert!(message.contains("column temperature_c: expected numbers") && message.contains(found), "{message}");
    }
}
