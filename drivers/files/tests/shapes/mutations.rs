//! Texts with changed, cut, doubled and moved bytes: read or refused, never a panic.
//!
//! `PROPTEST_CASES=100000 cargo test -p jointbench-files --test shapes mutated` tries more.

use super::files;
use jointbench_files::{Bounds, Choices, ReadOptions, understand_bytes};
use jointbench_instrument::{Kind, Meta};
use proptest::prelude::*;
use std::sync::LazyLock;

static SEEDS: LazyLock<Vec<(String, Vec<u8>)>> = LazyLock::new(|| {
    let read = |path: std::path::PathBuf| (path.display().to_string(), std::fs::read(&path).unwrap());
    files().into_iter().map(read).collect()
});

/// Bytes with a meaning in a table.
const TELLING: &[u8] = b",;\t|.\"'\n\r#-+eE 0:9TZ\0\xff\xe4";

#[derive(Debug, Clone)]
enum Change {
    Set(u8),
    Insert(u8),
    Remove(u8),
    Double(u8),
    Cut,
}

fn change() -> impl Strategy<Value = (f64, Change)> {
    let telling = || prop::sample::select(TELLING.to_vec());
    let change = prop_oneof![
        telling().prop_map(Change::Set),
        any::<u8>().prop_map(Change::Set),
        telling().prop_map(Change::Insert),
        any::<u8>().prop_map(Change::Remove),
        any::<u8>().prop_map(Change::Double),
        Just(Change::Cut),
    ];
    (0.0..1.0f64, change)
}

fn changed(seed: &[u8], changes: &[(f64, Change)]) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for (at, change) in changes {
        let at = (at * bytes.len() as f64) as usize;
        let until = |length: u8| bytes.len().min(at + usize::from(length));
        match change {
            Change::Set(byte) => bytes.iter_mut().skip(at).take(1).for_each(|old| *old = *byte),
            Change::Insert(byte) => bytes.insert(at, *byte),
            Change::Remove(length) => drop(bytes.drain(at..until(*length))),
            Change::Double(length) => {
                let piece = bytes[at..until(*length)].to_vec();
                drop(bytes.splice(at..at, piece));
            }
            Change::Cut => bytes.truncate(at.max(seed.len() / 2)),
        }
    }
    bytes
}

proptest! {
    #[test]
    fn a_mutated_text_is_read_or_refused(
        seed in any::<prop::sample::Index>(),
        changes in prop::collection::vec(change(), 1..5),
        (split_runs, spread_time, leave_empty_rows) in any::<(bool, bool, bool)>(),
    ) {
        let (name, bytes) = seed.get(&SEEDS);
        let choices = Choices { split_runs, spread_time, leave_empty_rows, ..Choices::default() };
        let meta = Some(Meta { kind: Some(Kind::Friction), ..Meta::default() });
        let options = ReadOptions { meta, bounds: Bounds::UPLOADED, ..choices.options().unwrap() };
        let read = understand_bytes(name, &changed(bytes, &changes), &options);
        match read.and_then(|understood| understood.into_run()) {
            Ok((run, _)) => prop_assert!(run.trace().columns().iter().all(|column| column.len() == run.len())),
            Err(refused) => prop_assert!(refused.to_string().contains(name.as_str())),
        }
    }
}
