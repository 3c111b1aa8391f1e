//! Writes the samples of simulated runs to a folder: `samples FOLDER RUNS ROWS`.

#[path = "../tests/common/mod.rs"]
mod common;

use common::{Run, samples};
use std::path::Path;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, runs, rows] = &arguments[..] else { panic!("usage: samples FOLDER RUNS ROWS") };
    let (runs, rows): (usize, usize) = (runs.parse().expect("a number"), rows.parse().expect("a number"));
    for number in 1..=runs {
        let run = Run { serial: format!("SN{number:05}"), number, ..Run::default() };
        run.write_samples(Path::new(folder), &samples(rows, number as u64));
    }
}
