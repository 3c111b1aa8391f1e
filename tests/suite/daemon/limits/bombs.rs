//! Small files that need much memory, and a long run.

use super::*;
use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use arrow_ipc::CompressionType;
use arrow_ipc::writer::{FileWriter, IpcWriteOptions};
use flate2::Compression;
use flate2::write::GzEncoder;
use jointbench_files::ParquetWriter;
use jointbench_instrument::{Channel, Kind, Meta, Trace};

const NAMES: [&str; 3] = ["time_s", "motor_position_rad", "motor_current_a"];

/// Zeros, compressed to a thousandth.
pub fn gzip() -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    let piece = vec![b'0'; 1 << 20];
    packed.write_all(b"time_s,motor_position_rad,motor_current_a\n").expect("memory");
    (0..600).for_each(|_| packed.write_all(&piece).expect("memory"));
    packed.finish().expect("memory")
}

/// The maximum number of rows: each column is one value with a repetition count.
pub fn parquet() -> Vec<u8> {
    let channels: Vec<Channel> = NAMES.iter().copied().chain(["a", "b", "c", "d", "e"]).map(Channel::new).collect();
    let meta = Meta { kind: Some(Kind::Friction), ..Meta::default() };
    let stretch = Trace::from_columns(channels.clone(), vec![vec![0.5; 1 << 20]; channels.len()]);
    let mut bytes = Vec::new();
    let mut writer = ParquetWriter::new(&mut bytes, &meta, &channels).expect("memory");
    (0..24).for_each(|_| writer.write(&stretch).expect("memory"));
    writer.finish().expect("memory");
    assert!(bytes.len() < 1 << 20, "{} bytes", bytes.len());
    bytes
}

/// A buffer that declares an uncompressed size of one terabyte.
pub fn arrow() -> Vec<u8> {
    let rows = 500;
    let column: ArrayRef = Arc::new(Float64Array::from_iter_values((0..rows).map(f64::from)));
    let batch = RecordBatch::try_from_iter(NAMES.map(|name| (name, column.clone()))).expect("columns of equal length");
    let options = IpcWriteOptions::default().try_with_compression(Some(CompressionType::ZSTD)).expect("it is there");
    let mut bytes = Vec::new();
    let mut writer = FileWriter::try_new_with_options(&mut bytes, &batch.schema(), options).expect("memory");
    writer.write(&batch).expect("memory");
    writer.finish().expect("memory");
    drop(writer);
    let length = (rows as u64 * 8).to_le_bytes();
    let at = bytes.windows(8).position(|bytes| bytes == length).expect("the length of the first buffer");
    bytes[at..at + 8].copy_from_slice(&(1_u64 << 40).to_le_bytes());
    bytes
}

/// Strokes at many speeds, as CSV.
pub fn long_run(rows: usize) -> Vec<u8> {
    let mut table = b"time_s,motor_position_rad,motor_velocity_rad_s,motor_current_a\n".to_vec();
    for row in 0..rows {
        let (time_s, phase) = (row as f64 * 0.001, row as f64 * 0.0005);
        let velocity = 20.0 * phase.sin() * (0.1 * phase).cos();
        let current = 0.4 * velocity.signum() + 0.01 * velocity + 0.001 * ((row * 7919 % 1000) as f64 - 500.0) / 500.0;
        let position = -20.0 / 0.5 * phase.cos();
        writeln!(table, "{time_s:.3},{position:.5},{velocity:.5},{current:.5}").expect("memory");
    }
    table
}
