//! A software stop before it is stored: a small file in the data folder. The stop survives the loss of both server and
//! worker, also while another program locks the database.

use crate::bench::leftovers;
use crate::store::SafetyRecord;
use std::collections::HashMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};

enum Event {
    Pressed(SafetyRecord),
    /// Time of the stored stop.
    Stored(String),
}

/// Uses a separate thread, so that a blocked disk does not delay orders.
#[derive(Clone)]
pub(super) struct PressFiles {
    events: Sender<Event>,
}

impl PressFiles {
    pub fn start(data: &Path, bench: &str) -> io::Result<Self> {
        let (events, received) = channel();
        let (data, bench) = (data.to_owned(), bench.to_owned());
        std::thread::Builder::new().name("presses".into()).spawn(move || keep(&received, &data, &bench))?;
        Ok(Self { events })
    }

    pub fn pressed(&self, block: SafetyRecord) {
        self.send(Event::Pressed(block));
    }

    pub fn stored(&self, at: &str) {
        self.send(Event::Stored(at.to_owned()));
    }

    fn send(&self, event: Event) {
        if self.events.send(event).is_err() {
            tracing::error!("the thread that keeps presses of the software stop has ended");
        }
    }
}

fn keep(received: &Receiver<Event>, data: &Path, bench: &str) {
    let mut files: HashMap<String, PathBuf> = HashMap::new();
    for event in received {
        match event {
            Event::Pressed(block) => {
                let at = block.at.clone();
                files.extend(leftovers::leave(data, bench, Some(block), &[]).map(|path| (at, path)));
            }
            Event::Stored(at) => {
                // The next start stores a remaining file again, which has no effect.
                if let Some(path) = files.remove(&at)
                    && let Err(fault) = fs::remove_file(&path)
                {
                    tracing::warn!(file = %path.display(), %fault, "the press is stored, but its file is not removed");
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::Store;
    use std::time::{Duration, Instant};

    fn files(data: &Path) -> usize {
        fs::read_dir(data.join("unstored")).map_or(0, Iterator::count)
    }

    fn wait_for(data: &Path, count: usize) {
        let give_up = Instant::now() + Duration::from_secs(20);
        while files(data) != count && Instant::now() < give_up {
            std::thread::sleep(Duration::from_millis(5));
        }
        assert_eq!(files(data), count);
    }

    #[tokio::test]
    async fn a_press_is_a_file_until_it_is_stored_and_the_next_start_stores_it_once() {
        let data = tempfile::tempdir().unwrap();
        let presses = PressFiles::start(data.path(), "a").unwrap();
        let block = |at: &str| SafetyRecord {
            blocked: true,
            stopped: true,
            reason: "software stop".into(),
            run: None,
            by: Some("a person".into()),
            at: at.into(),
        };
        presses.pressed(block("2026-01-01T00:00:00Z"));
        presses.pressed(block("2026-01-01T00:00:01Z"));
        wait_for(data.path(), 2);
        presses.stored("2026-01-01T00:00:01Z");
        wait_for(data.path(), 1);
        let store = Store::open(data.path()).await.unwrap();
        for _ in 0..2 {
            leftovers::store_all(data.path(), &store).await.unwrap();
            assert_eq!(store.safety("a", 10).await.unwrap().len(), 1);
        }
        assert_eq!(files(data.path()), 0);
    }
}
