//! One monotonic clock for a bench. The mock bench brings its own, which moves only when somebody waits.

use std::time::{Duration, Instant};

/// The bench's time. Seconds since the bench was opened.
pub trait Clock: Send + Sync {
    fn now_s(&self) -> f64;

    /// Returns when the clock shows `t_s` or later. At once where that is past.
    fn sleep_until_s(&self, t_s: f64);
}

/// A moment of which is known only that it lay between two: their middle, and how far it may be off either way.
pub fn between(from_s: f64, until_s: f64) -> (f64, f64) {
    (0.5 * (from_s + until_s), 0.5 * (until_s - from_s))
}

/// Wall time, for real instruments.
pub struct SystemClock {
    opened: Instant,
}

impl SystemClock {
    pub fn start() -> Self {
        Self { opened: Instant::now() }
    }
}

impl Clock for SystemClock {
    fn now_s(&self) -> f64 {
        self.opened.elapsed().as_secs_f64()
    }

    fn sleep_until_s(&self, t_s: f64) {
        let wait_s = t_s - self.now_s();
        if wait_s > 0.0 {
            std::thread::sleep(Duration::from_secs_f64(wait_s));
        }
    }
}
