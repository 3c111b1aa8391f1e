//! Writes a simulated fleet to a folder: `fleet FOLDER [UNITS_PER_BATCH [ROWS [STRIBECK_SHARE [SHIFT_MNM [SEED]]]]]`.
//! Five batches; the shift is that of the Coulomb friction of batch B4. `STRIBECK_MNM` sets the size of the Stribeck
//! effect. Prints the serial numbers of the units with it.

#[path = "../tests/common/mod.rs"]
mod common;

use common::{Fleet, write};
use std::path::Path;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |at: usize, default: f64| arguments.get(at).map_or(default, |text| text.parse().expect("a number"));
    let folder = arguments.first().expect("usage: fleet FOLDER [UNITS_PER_BATCH [ROWS [SHARE [SHIFT_MNM [SEED]]]]]");
    let shift_nm = 1e-3 * number(4, 1.0);
    let stribeck_mnm = std::env::var("STRIBECK_MNM").map_or(12.0, |text| text.parse().expect("a number"));
    let fleet = Fleet {
        stribeck_nm: 1e-3 * stribeck_mnm,
        units_per_batch: number(1, 400.0) as usize,
        least_rows: number(2, 0.0) as usize,
        stribeck_share: number(3, 0.03),
        shift: (shift_nm != 0.0).then_some((3, shift_nm)),
        seed: number(5, 1.0) as u64,
        ..Fleet::default()
    };
    let truth = write(Path::new(folder), &fleet);
    truth.planted.iter().for_each(|serial| println!("{serial}"));
}
