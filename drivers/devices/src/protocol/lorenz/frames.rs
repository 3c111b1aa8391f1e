//! The stream of special mode 3: `index A B`, five bytes, without framing, stuffing or checksum. Only the index, which
//! wraps after 255, identifies the frames and shows losses.

use std::cmp::Reverse;

/// Unit of the stream period.
pub const PERIOD_STEP_S: f64 = 200e-6;
const LENGTH: usize = 5;
/// Consecutive frames that are required after a loss before any of them is accepted.
const RUN: usize = 8;
/// Limit of the buffer while no frames are found.
const LIMIT: usize = 4096;

/// Calibrated counts of channels A and B.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frame {
    /// Number of the frame, modulo 256.
    pub index: u8,
    /// Channels A and B; [`super::NOMINAL_COUNTS`] at nominal torque.
    pub counts: [i16; 2],
}

/// Content of the stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Item {
    /// One accepted frame.
    Frame(Frame),
    /// Number of missing frames modulo 256; the index does not give more.
    Gap {
        /// Missing frames, modulo 256.
        count: u8,
    },
}

/// Finds the frames in the received bytes, from the first byte after the reply that started the stream.
#[derive(Debug, Default)]
pub struct Frames {
    bytes: Vec<u8>,
    next: u8,
}

impl Frames {
    /// Adds received bytes; the iterator returns the frames in them.
    pub fn push(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// Frames that are received but not yet accepted.
    pub fn waiting(&self) -> u64 {
        (self.bytes.len() / LENGTH) as u64
    }

    /// Number of frames from `at` on with rising indices from `index` on, at most `most`.
    fn frames(&self, at: usize, index: u8, most: usize) -> usize {
        let indices = self.bytes.get(at..).unwrap_or_default().iter().step_by(LENGTH).take(most);
        let follows = |(number, byte): &(usize, &u8)| **byte == index.wrapping_add(*number as u8);
        indices.enumerate().take_while(follows).count()
    }

    fn run(&self, at: usize, index: u8, count: usize) -> bool {
        self.frames(at, index, count) == count
    }

    /// Start of the frames after a loss. A torque that rises by one count per frame looks like an index for a while. Of
    /// overlapping candidates the longest is chosen, if it is clearly longer; otherwise more frames are needed.
    fn start(&self) -> Option<usize> {
        let in_place = |place: usize| {
            let mut starts = (place..self.bytes.len()).step_by(LENGTH);
            starts.find_map(|at| {
                Some((at, self.frames(at, self.bytes[at], usize::MAX))).filter(|(_, frames)| *frames >= RUN)
            })
        };
        let runs: Vec<(usize, usize)> = (0..LENGTH).filter_map(in_place).collect();
        let (first, frames) = *runs.iter().min()?;
        let mut rivals: Vec<_> = runs.into_iter().filter(|(at, _)| *at < first + frames * LENGTH).collect();
        rivals.sort_by_key(|(_, frames)| Reverse(*frames));
        match rivals[..] {
            [(start, _)] => Some(start),
            [(start, longest), (_, next), ..] if longest > next + 2 => Some(start),
            _ => None,
        }
    }

    fn take(&mut self) -> Item {
        let word = |at: usize| i16::from_be_bytes([self.bytes[at], self.bytes[at + 1]]);
        let frame = Frame { index: self.bytes[0], counts: [word(1), word(3)] };
        self.bytes.drain(..LENGTH);
        self.next = self.next.wrapping_add(1);
        Item::Frame(frame)
    }
}

impl Iterator for Frames {
    type Item = Item;

    /// Accepts a frame when the next two frames have the right index. If bytes are lost inside a frame, its index is
    /// right and its torque is wrong; this check rejects it.
    fn next(&mut self) -> Option<Item> {
        if self.run(0, self.next, 3) {
            return Some(self.take());
        }
        if self.bytes.len() < 3 * LENGTH {
            return None;
        }
        let Some(start) = self.start() else {
            let surplus = self.bytes.len().saturating_sub(LIMIT);
            self.bytes.drain(..surplus);
            return None;
        };
        // Either whole frames are lost, or bytes inside one. In the first case all earlier frames are valid except the
        // last, which may join the head of one frame and the tail of another.
        let whole = start.is_multiple_of(LENGTH) && start > LENGTH && self.run(0, self.next, 2);
        if whole {
            return Some(self.take());
        }
        let count = self.bytes[start].wrapping_sub(self.next);
        self.next = self.bytes[start];
        self.bytes.drain(..start);
        Some(Item::Gap { count })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(number: usize) -> [u8; LENGTH] {
        let torque = 37 * number as i16;
        let [a, b] = [torque.to_be_bytes(), (-torque).to_be_bytes()];
        [number as u8, a[0], a[1], b[0], b[1]]
    }

    fn stream(numbers: impl Iterator<Item = usize>) -> Vec<u8> {
        numbers.flat_map(frame).collect()
    }

    /// All items of a stream that arrives in pieces. Accepted frames must equal the sent frames.
    fn items(bytes: &[u8], piece: usize) -> Vec<Item> {
        let mut frames = Frames::default();
        let mut items = Vec::new();
        for bytes in bytes.chunks(piece) {
            frames.push(bytes);
            items.extend(frames.by_ref());
        }
        items
    }

    fn check(bytes: &[u8], believed: &[usize], gaps: &[u8]) {
        for piece in [1, 7, 64, 10_000] {
            let items = items(bytes, piece);
            let frames: Vec<[u8; LENGTH]> = items
                .iter()
                .filter_map(|item| match item {
                    Item::Frame(Frame { index, counts: [a, b] }) => {
                        Some([*index, a.to_be_bytes()[0], a.to_be_bytes()[1], b.to_be_bytes()[0], b.to_be_bytes()[1]])
                    }
                    Item::Gap { .. } => None,
                })
                .collect();
            assert_eq!(frames, believed.iter().map(|number| frame(*number)).collect::<Vec<_>>(), "pieces of {piece}");
            let found: Vec<u8> = items
                .iter()
                .filter_map(|item| if let Item::Gap { count } = item { Some(*count) } else { None })
                .collect();
            assert_eq!(found, gaps, "pieces of {piece}");
        }
    }

    fn upto(range: std::ops::Range<usize>) -> Vec<usize> {
        range.collect()
    }

    #[test]
    fn frames_in_order_are_all_believed_but_the_last_two() {
        check(&stream(0..600), &upto(0..598), &[]);
    }

    #[test]
    fn lost_frames_are_counted_with_the_unverified_one() {
        let bytes = stream((0..100).chain(107..300));
        let believed = [upto(0..99), upto(107..298)].concat();
        check(&bytes, &believed, &[8]);
    }

    #[test]
    fn lost_bytes_cost_the_frames_they_hit_and_no_more_than_two_before() {
        let whole = stream(0..300);
        for lost in 1..12 {
            for at in 500..505 {
                let bytes = [&whole[..at], &whole[at + lost..]].concat();
                let items = items(&bytes, 64);
                let gap: u32 =
                    items.iter().map(|i| if let Item::Gap { count } = i { u32::from(*count) } else { 0 }).sum();
                assert!((1..=6).contains(&gap), "{lost} bytes lost at {at}: {gap}");
                for item in &items {
                    if let Item::Frame(Frame { index, counts: [a, b] }) = item {
                        let expected = [usize::from(*index), usize::from(*index) + 256].map(|n| 37 * n as i16);
                        assert!(expected.contains(a) && *b == -a, "{lost} bytes lost at {at}: {item:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_torque_that_rises_like_an_index_is_found_out() {
        // The small range rises by one count per frame for a while, in step with a byte that was lost before.
        let rising = |number: usize| {
            let low = if (20..60).contains(&number) { number as u8 } else { 7 };
            [number as u8, 0, 9, 0, low]
        };
        let bytes: Vec<u8> =
            (0..200).flat_map(rising).enumerate().filter(|(at, _)| *at != 97).map(|(_, b)| b).collect();
        let items = items(&bytes, 64);
        let frames = items.iter().filter_map(|item| if let Item::Frame(frame) = item { Some(frame) } else { None });
        assert!(frames.clone().count() > 190, "{}", frames.count());
        for Frame { index, counts } in frames {
            assert_eq!(counts.map(i16::to_be_bytes).as_flattened(), &rising(usize::from(*index))[1..]);
        }
    }

    #[test]
    fn losses_close_together_do_not_stop_the_stream() {
        let whole = stream(0..200);
        // Two bytes lost, with several frames between them, and all bytes arrive at once.
        let bytes = [&whole[..502], &whole[503..560], &whole[561..]].concat();
        let items = items(&bytes, 10_000);
        let last =
            items.iter().rev().find_map(|item| if let Item::Frame(frame) = item { Some(frame.index) } else { None });
        assert_eq!(last, Some(197));
    }

    #[test]
    fn noise_is_never_a_frame_and_costs_bounded_memory() {
        let mut frames = Frames::default();
        for _ in 0..100 {
            frames.push(&[0x55; 1000]);
            assert_eq!(frames.next(), None);
        }
        assert!(frames.bytes.len() <= LIMIT, "{}", frames.bytes.len());
    }
}
