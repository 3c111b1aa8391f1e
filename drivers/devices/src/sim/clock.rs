//! The mock bench's time: it moves when somebody waits, and only then.

use super::rig::Rig;
use jointbench_instrument::Clock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The rig is let go between slices of this length, so that instruments can be asked meanwhile.
const SLICE_S: f64 = 0.02;

pub struct SteppedClock {
    rig: Arc<Mutex<Rig>>,
    now_bits: AtomicU64,
    /// Bench seconds for each second of wall time; `None`: as fast as it goes.
    pace: Option<f64>,
    opened: Instant,
}

impl SteppedClock {
    pub fn new(rig: Arc<Mutex<Rig>>, pace: Option<f64>) -> Self {
        Self { rig, now_bits: AtomicU64::new(0), pace, opened: Instant::now() }
    }

    fn keep_pace(&self, now_s: f64) {
        let Some(pace) = self.pace else { return };
        let ahead_s = now_s / pace - self.opened.elapsed().as_secs_f64();
        if ahead_s > 0.0 {
            std::thread::sleep(Duration::from_secs_f64(ahead_s));
        }
    }
}

impl Clock for SteppedClock {
    fn now_s(&self) -> f64 {
        f64::from_bits(self.now_bits.load(Ordering::Acquire))
    }

    fn sleep_until_s(&self, t_s: f64) {
        while self.now_s() < t_s {
            let slice_s = t_s.min(self.now_s() + SLICE_S);
            {
                let mut rig = self.rig.lock().unwrap_or_else(PoisonError::into_inner);
                rig.advance_until(slice_s);
                // The time asked for, not the substep's: readings a period apart then differ by exactly that period.
                self.now_bits.store(slice_s.to_bits(), Ordering::Release);
            }
            self.keep_pace(slice_s);
        }
    }
}
