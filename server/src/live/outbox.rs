//! Queue of one client. Waiting rows are merged into one frame; excess data is dropped and counted.

use super::frame;
use super::hub::{Piece, Rows};
use crate::view::{ChannelInfo, LiveMessage};
use jointbench_instrument::{Channel, Trace};

/// A larger frame loses its oldest rows: a slow client gets less data, but no older data.
const LARGEST_FRAME_ROWS: usize = 8192;
const LARGEST_QUEUE: usize = 512;

#[derive(Debug, PartialEq)]
pub enum Frame {
    Text(String),
    Binary(Vec<u8>),
}

#[derive(Default)]
pub struct Outbox {
    texts: Vec<String>,
    /// Waiting rows of each active run.
    waiting: Vec<Rows>,
    /// Run and channels of the last channel message to the client.
    sent_channels: Option<(i64, Vec<Channel>)>,
    sequence: u32,
    dropped: u32,
}

impl Outbox {
    pub fn put(&mut self, piece: &Piece) {
        match piece {
            Piece::Message(message) => self.text(message),
            Piece::Rows(rows) => self.rows(rows),
        }
    }

    /// Counts pieces that the hub has dropped for this client.
    pub fn lost(&mut self, pieces: u64) {
        self.dropped = self.dropped.saturating_add(pieces.min(u64::from(u32::MAX)) as u32);
    }

    pub fn text(&mut self, message: &LiveMessage) {
        // Messages that are dropped here are still available over REST.
        if self.texts.len() < LARGEST_QUEUE {
            self.texts.push(json(message));
        } else {
            self.lost(1);
        }
    }

    fn rows(&mut self, piece: &Rows) {
        let same = |waiting: &Rows| waiting.run == piece.run && waiting.rows.channels() == piece.rows.channels();
        let at = self.waiting.iter().position(same).unwrap_or(self.waiting.len());
        match self.waiting.get_mut(at) {
            Some(waiting) => waiting.rows.append(piece.rows.clone()),
            None => self.waiting.push(piece.clone()),
        }
        let rows = &mut self.waiting[at].rows;
        if rows.len() > LARGEST_FRAME_ROWS {
            let newest = rows.columns().iter().map(|c| c[c.len() - LARGEST_FRAME_ROWS..].to_vec()).collect();
            *rows = Trace::from_columns(rows.channels().to_vec(), newest);
            self.dropped = self.dropped.saturating_add(1);
        }
    }

    /// All waiting data as frames: text first, then the rows of each run behind its channels.
    pub fn take(&mut self) -> Vec<Frame> {
        let mut frames: Vec<Frame> = self.texts.drain(..).map(Frame::Text).collect();
        for Rows { bench, run, rows } in self.waiting.drain(..).filter(|waiting| !waiting.rows.is_empty()) {
            let channels = rows.channels();
            if !self.sent_channels.as_ref().is_some_and(|(sent, known)| *sent == run && known == channels) {
                self.sent_channels = Some((run, channels.to_vec()));
                let channels = channels.iter().map(ChannelInfo::from).collect();
                frames.push(Frame::Text(json(&LiveMessage::Channels { bench, run, channels })));
            }
            frames.push(Frame::Binary(frame::encode(self.sequence, self.dropped, &rows)));
            self.sequence = self.sequence.wrapping_add(1);
        }
        frames
    }
}

fn json(message: &LiveMessage) -> String {
    serde_json::to_string(message).expect("a live message is plain JSON")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    fn rows(run: i64, from: usize, count: usize) -> Piece {
        let time_s = (from..from + count).map(|i| i as f64 * 0.004).collect();
        let rows = Trace::from_columns(vec![Channel::new("time_s")], vec![time_s]);
        Piece::Rows(Arc::new(Rows { bench: "a".into(), run, rows }))
    }

    fn header(frame: &Frame) -> [u32; 4] {
        let Frame::Binary(bytes) = frame else { panic!("a binary frame, not {frame:?}") };
        std::array::from_fn(|i| u32::from_le_bytes(bytes[4 * i..4 * i + 4].try_into().unwrap()))
    }

    #[test]
    fn rows_that_wait_become_one_frame_behind_their_channels() {
        let mut outbox = Outbox::default();
        (0..5).for_each(|i| outbox.put(&rows(1, 10 * i, 10)));
        let frames = outbox.take();
        assert_eq!(frames.len(), 2);
        assert!(matches!(&frames[0], Frame::Text(text) if text.contains("\"channels\"")), "{frames:?}");
        assert_eq!(header(&frames[1]), [0, 0, 50, 1]);
        outbox.put(&rows(1, 50, 10));
        assert_eq!(header(&outbox.take()[0]), [1, 0, 10, 1], "the channels are known by now");
    }

    #[test]
    fn a_slow_client_gets_the_newest_rows_and_learns_of_the_loss() {
        let mut outbox = Outbox::default();
        (0..20).for_each(|i| outbox.put(&rows(1, 1000 * i, 1000)));
        let frames = outbox.take();
        let [_, dropped, count, _] = header(&frames[1]);
        assert_eq!(count as usize, LARGEST_FRAME_ROWS);
        assert!(dropped > 0);
        let Frame::Binary(bytes) = &frames[1] else { unreachable!() };
        let t0_s = f64::from_le_bytes(bytes[16..24].try_into().unwrap());
        assert_eq!(t0_s, (20_000 - LARGEST_FRAME_ROWS) as f64 * 0.004);
    }

    #[test]
    fn rows_of_another_run_never_share_a_frame() {
        let mut outbox = Outbox::default();
        outbox.put(&rows(1, 0, 10));
        outbox.put(&rows(2, 0, 3));
        let frames = outbox.take();
        assert!(matches!(&frames[2], Frame::Text(text) if text.contains("\"run\":2")), "{frames:?}");
        assert_eq!([&frames[1], &frames[3]].map(header), [[0, 0, 10, 1], [1, 0, 3, 1]]);
        outbox.put(&rows(1, 10, 5));
        let frames = outbox.take();
        assert!(matches!(&frames[0], Frame::Text(text) if text.contains("\"run\":1")), "{frames:?}");
        assert_eq!(header(&frames[1]), [2, 0, 5, 1]);
    }
}
