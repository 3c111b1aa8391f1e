//! Broken files of every form: each is refused or read without a panic, in limited memory.
//!
//! Runs in its own process with a limited address space: an allocation with a broken length would abort it.
//! `JOINTBENCH_MUTATIONS=100000 cargo test -p jointbench-files --test mutated` tries more.

mod seeds;

use jointbench_files::{Bounds, ReadOptions, read_bytes};
use jointbench_instrument::{Kind, Meta};
use rustix::process::{Resource, Rlimit, setrlimit};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

const TRIES: u64 = 2_000;
/// Address space of the whole test.
const MEMORY_BYTES: u64 = 2 << 30;

/// xorshift64*: the same mutations in every run.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, below: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        ((self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize) % below.max(1)
    }
}

/// Values at which lengths and offsets are prone to errors.
const EDGES: [u64; 8] = [0, 1, u64::MAX, i64::MAX as u64, 1 << 31, u32::MAX as u64, i32::MAX as u64, 1 << 40];

fn mutate(file: &mut Vec<u8>, dice: &mut Dice) {
    for _ in 0..=dice.roll(4) {
        let at = dice.roll(file.len());
        match dice.roll(6) {
            0 => file[at] ^= 1 << dice.roll(8),
            1 => file[at] = [0, 1, 0x7f, 0x80, 0xff][dice.roll(5)],
            2 => {
                let width = [4, 8][dice.roll(2)];
                let value = EDGES[dice.roll(EDGES.len())].to_le_bytes();
                let end = file.len().min(at + width);
                file[at..end].copy_from_slice(&value[..end - at]);
            }
            3 => file.truncate(at.max(12)),
            4 => {
                let (from, length) = (dice.roll(file.len()), dice.roll(64));
                let piece = file[from..file.len().min(from + length)].to_vec();
                file.splice(at..at, piece);
            }
            _ => {
                let end = file.len().min(at + dice.roll(64));
                // The heads and tails of both forms are short.
                if file.len() - (end - at) > 12 {
                    file.drain(at..end);
                }
            }
        }
    }
}

#[test]
fn a_broken_file_is_refused() {
    setrlimit(Resource::As, Rlimit { current: Some(MEMORY_BYTES), maximum: Some(MEMORY_BYTES) }).unwrap();
    let tries = std::env::var("JOINTBENCH_MUTATIONS").map_or(TRIES, |tries| tries.parse().unwrap());
    let meta = Meta { kind: Some(Kind::Friction), ..Meta::default() };
    let leave = vec!["remark".to_owned()];
    let options = ReadOptions { meta: Some(meta), leave, bounds: Bounds::UPLOADED, ..ReadOptions::default() };
    let seeds = seeds::all();
    for (name, seed) in &seeds {
        read_bytes(name, seed, &options).unwrap_or_else(|fault| panic!("the seed is whole: {fault}"));
    }
    // Panics inside a decoder become refusals; their messages are not needed here.
    let caught = Arc::<AtomicU64>::default();
    let count = caught.clone();
    std::panic::set_hook(Box::new(move |_| {
        count.fetch_add(1, Ordering::Relaxed);
    }));
    let (mut refused, mut escaped) = (0, Vec::new());
    for number in 0..tries {
        let (name, seed) = &seeds[number as usize % seeds.len()];
        let mut file = seed.clone();
        mutate(&mut file, &mut Dice(number.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1));
        match catch_unwind(AssertUnwindSafe(|| read_bytes(name, &file, &options))) {
            Ok(read) => refused += u64::from(read.is_err()),
            Err(_) => escaped.push(number),
        }
    }
    drop(std::panic::take_hook());
    let caught = caught.load(Ordering::Relaxed) - escaped.len() as u64;
    println!("{tries} files: {refused} refused ({caught} after a panic of a decoder), the others read");
    assert!(escaped.is_empty(), "mutations {escaped:?} end by a panic");
    assert!(refused > tries / 4, "{refused} of {tries} are refused");
}
