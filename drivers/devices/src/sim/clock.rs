//! The time of the mock bench: it advances only while a caller waits.

use super::rig::Rig;
use jointbench_instrument::Clock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The rig is unlocked between slices of this length, so that instruments can be asked meanwhile.
const SLICE_S: f64 = 0.02;
/// The longest delay to catch up. A bench that was idle for minutes must not race through the next run.
const FORGIVEN: Duration = Duration::from_millis(100);

pub struct SteppedClock {
    rig: Arc<Mutex<Rig>>,
    now_bits: AtomicU64,
    /// Bench seconds per second of wall time; `None`: as fast as possible.
    pace: Option<f64>,
    /// Wall time that corresponds to the present bench time.
    due: Mutex<Instant>,
}

impl SteppedClock {
    pub fn new(rig: Arc<Mutex<Rig>>, pace: Option<f64>) -> Self {
        Self { rig, now_bits: AtomicU64::new(0), pace, due: Mutex::new(Instant::now()) }
    }

    fn keep_pace(&self, passed_s: f64) {
        let Some(pace) = self.pace else { return };
        let now = Instant::now();
        let wait = {
            let mut due = self.due.lock().unwrap_or_else(PoisonError::into_inner);
            *due = (*due + Duration::from_secs_f64(passed_s / pace)).max(now.checked_sub(FORGIVEN).unwrap_or(now));
            due.saturating_duration_since(now)
        };
        std::thread::sleep(wait);
    }
}

impl Clock for SteppedClock {
    fn now_s(&self) -> f64 {
        f64::from_bits(self.now_bits.load(Ordering::Acquire))
    }

    fn sleep_until_s(&self, t_s: f64) {
        while self.now_s() < t_s {
            let passed_s = {
                let mut rig = self.rig.lock().unwrap_or_else(PoisonError::into_inner);
                // Another waiting caller may have advanced it meanwhile.
                let before_s = self.now_s();
                let slice_s = before_s.max(t_s.min(before_s + SLICE_S));
                rig.advance_until(slice_s);
                // The requested time, not that of the substep: readings one period apart then differ by exactly that
                // period.
                self.now_bits.store(slice_s.to_bits(), Ordering::Release);
                slice_s - before_s
            };
            self.keep_pace(passed_s);
        }
    }
}
