//! One monotonic clock for a bench. The mock bench has its own clock, which advances only while a caller waits.

use std::time::{Duration, Instant};

/// The time of the bench, in seconds since the bench was opened.
pub trait Clock: Send + Sync {
    /// Seconds since the bench was opened; never falls.
    fn now_s(&self) -> f64;

    /// Returns when the clock shows `t_s` or later, immediately if that time is past.
    fn sleep_until_s(&self, t_s: f64);
}

/// Midpoint of an interval that contains a moment, and the largest error of that midpoint in either direction.
pub fn between(from_s: f64, until_s: f64) -> (f64, f64) {
    (0.5 * (from_s + until_s), 0.5 * (until_s - from_s))
}

/// A reading with its time on the bench clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timed<T> {
    /// The reading.
    pub value: T,
    /// Time of the reading on the bench clock (s).
    pub at_s: f64,
    /// Largest error of [`Timed::at_s`], in either direction.
    pub uncertainty_s: f64,
}

/// A reading with the midpoint between request and reply as its time.
pub fn timed<T, E>(clock: &dyn Clock, read: impl FnOnce() -> Result<T, E>) -> Result<Timed<T>, E> {
    let asked_s = clock.now_s();
    let value = read()?;
    let (at_s, uncertainty_s) = between(asked_s, clock.now_s());
    Ok(Timed { value, at_s, uncertainty_s })
}

/// Wall time, for real instruments.
pub struct SystemClock {
    opened: Instant,
}

impl SystemClock {
    /// A clock that shows 0 now.
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
