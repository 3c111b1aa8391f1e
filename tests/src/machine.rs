//! Load of the machine: distinguishes a delay of the program from missing processor time.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// A thread that sleeps and measures how much longer than requested it slept.
pub struct Watch {
    over: Arc<AtomicBool>,
    longest_us: Arc<AtomicU64>,
    thread: Option<JoinHandle<()>>,
}

const ASKED: Duration = Duration::from_millis(1);

impl Watch {
    pub fn start() -> Self {
        let (over, longest_us) = (Arc::<AtomicBool>::default(), Arc::<AtomicU64>::default());
        let (ends, longest) = (over.clone(), longest_us.clone());
        let thread = std::thread::spawn(move || {
            while !ends.load(Ordering::Acquire) {
                let begun = Instant::now();
                std::thread::sleep(ASKED);
                let stall = begun.elapsed().saturating_sub(ASKED);
                longest.fetch_max(stall.as_micros() as u64, Ordering::AcqRel);
            }
        });
        Self { over, longest_us, thread: Some(thread) }
    }

    /// The longest stall since the last call.
    pub fn longest(&self) -> Duration {
        Duration::from_micros(self.longest_us.swap(0, Ordering::AcqRel))
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            // It cannot panic.
            let _ = thread.join();
        }
    }
}
