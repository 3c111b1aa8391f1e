//! Random kills, stalls and locks.

use crate::lab::Lab;
use crate::trouble::Held;
use crate::wire::now_s;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rustix::process::Signal;
use std::time::Duration;

const PEACE_MS: std::ops::Range<u64> = 200..1500;
const STALLED_MS: std::ops::Range<u64> = 500..3000;
/// Near the lock timeout of the database, 5 s.
const HELD_MS: std::ops::Range<u64> = 500..7000;
/// Time limit after SIGTERM during a run.
const ENDS: Duration = Duration::from_secs(60);

pub struct Nemesis {
    random: ChaCha8Rng,
    pub faults: usize,
    pub both_killed_s: Vec<f64>,
}

impl Nemesis {
    pub fn new(random: ChaCha8Rng) -> Self {
        Self { random, faults: 0, both_killed_s: Vec::new() }
    }

    /// One fault after a pause without faults. The server runs afterwards.
    pub fn strike(&mut self, lab: &mut Lab) {
        self.sleep(PEACE_MS);
        self.faults += 1;
        match self.random.random_range(0..10) {
            0..2 => {
                lab.kill_server();
                lab.start();
            }
            2..4 => drop(lab.kill_worker()),
            4 => {
                self.both_killed_s.push(now_s());
                lab.kill_both();
                lab.start();
            }
            5 => {
                lab.terminate(ENDS);
                lab.start();
            }
            6..8 => {
                lab.signal_server(Signal::STOP);
                self.sleep(STALLED_MS);
                lab.signal_server(Signal::CONT);
            }
            _ => {
                let held = Held::hold(&lab.database());
                self.sleep(HELD_MS);
                drop(held);
            }
        }
    }

    fn sleep(&mut self, range_ms: std::ops::Range<u64>) {
        std::thread::sleep(Duration::from_millis(self.random.random_range(range_ms)));
    }
}
