//! Valid files of every form and compression.

use arrow_array::{ArrayRef, BooleanArray, Float64Array, Int32Array, RecordBatch, StringArray, UInt64Array};
use arrow_ipc::CompressionType;
use arrow_ipc::writer::{FileWriter, IpcWriteOptions};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, ZstdLevel};
use parquet::file::properties::{WriterProperties, WriterVersion};
use std::sync::Arc;

const ROWS: u32 = 300;

/// Name and bytes.
pub fn all() -> Vec<(&'static str, Vec<u8>)> {
    let zstd = Compression::ZSTD(ZstdLevel::try_new(3).unwrap());
    let mut seeds = Vec::new();
    for (packing, version) in [
        (zstd, WriterVersion::PARQUET_1_0),
        (Compression::SNAPPY, WriterVersion::PARQUET_2_0),
        (Compression::UNCOMPRESSED, WriterVersion::PARQUET_2_0),
    ] {
        seeds.push(("run.parquet", parquet(packing, version)));
    }
    for packing in [None, Some(CompressionType::LZ4_FRAME), Some(CompressionType::ZSTD)] {
        seeds.push(("run.arrow", arrow(packing)));
    }
    seeds
}

fn batch() -> RecordBatch {
    let of = |f: fn(f64) -> f64| -> ArrayRef {
        Arc::new(Float64Array::from_iter_values((0..ROWS).map(|row| f(f64::from(row)))))
    };
    let columns: [(&str, ArrayRef); 7] = [
        ("time_s", of(|row| row * 0.004)),
        ("motor_position_rad", of(f64::sin)),
        ("motor_current_a", of(|_| 0.25)),
        ("segment", Arc::new(Int32Array::from_iter_values((0..ROWS as i32).map(|row| row / 50)))),
        ("count", Arc::new(UInt64Array::from_iter_values((0..u64::from(ROWS)).map(|row| row * row)))),
        ("on", Arc::new(BooleanArray::from_iter((0..ROWS).map(|row| Some(row % 3 == 0))))),
        ("remark", Arc::new(StringArray::from_iter((0..ROWS).map(|row| (row % 7 > 0).then_some("warm"))))),
    ];
    RecordBatch::try_from_iter_with_nullable(columns.map(|(name, column)| (name, column, name == "remark"))).unwrap()
}

fn parquet(packing: Compression, version: WriterVersion) -> Vec<u8> {
    let batch = batch();
    let properties = WriterProperties::builder()
        .set_compression(packing)
        .set_writer_version(version)
        .set_max_row_group_row_count(Some(128))
        .set_data_page_row_count_limit(64)
        .build();
    let mut bytes = Vec::new();
    let mut writer = ArrowWriter::try_new(&mut bytes, batch.schema(), Some(properties)).unwrap();
    writer.write(&batch).unwrap();
    writer.close().unwrap();
    bytes
}

fn arrow(packing: Option<CompressionType>) -> Vec<u8> {
    let batch = batch();
    let options = IpcWriteOptions::default().try_with_compression(packing).unwrap();
    let mut bytes = Vec::new();
    let mut writer = FileWriter::try_new_with_options(&mut bytes, &batch.schema(), options).unwrap();
    for first in (0..ROWS as usize).step_by(100) {
        writer.write(&batch.slice(first, 100)).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    bytes
}
