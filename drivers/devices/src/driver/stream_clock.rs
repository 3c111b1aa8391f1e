//! Times of a stream's samples on the bench clock, computed from their numbers alone.
//!
//! A stream has no time stamps. Its first sample is one period later than the start command, which was sent between two
//! readings of the bench clock. From then on the quartz of the sensor determines the rate. Each read of the stream
//! limits start and rate: the newest sample was taken before the read and, because reads are spread over the period,
//! not long before it. The possible values of start and drift form a polygon. Its width at a sample is the uncertainty
//! of that sample's time (set membership; Milanese and Vicino 1991).

/// Bound of the quartz frequency error (assumed: 50 ppm parts on both sides).
const QUARTZ_TOLERANCE: f64 = 100e-6;
/// Upper bound of the shortest transmission time from the sensor (assumed: 5 bytes at 230400 baud take 0.22 ms).
const SHORTEST_WAY_S: f64 = 0.25e-3;
/// Largest error of a reading of the bench clock.
const GRAIN_S: f64 = 0.1e-3;
/// A bench often reads at a multiple of the period, always at the same age of the newest sample. Therefore one of every
/// `LOOKS_BETWEEN` reads is delayed, each time by another multiple of 1/`PARTS` of the period.
const PARTS: u64 = 8;
const LOOKS_BETWEEN: u64 = 4;
/// The sample with the shortest delay represents all reads of one cycle through the parts.
const BLOCK: u64 = PARTS * LOOKS_BETWEEN;

pub struct StreamClock {
    period_s: f64,
    started_s: f64,
    /// Corners of the possible (start, drift per sample), relative to the nominal times.
    possible: Vec<(f64, f64)>,
    looks: u64,
    soonest: Option<(u64, f64)>,
}

/// A time on the bench clock, and its largest error in either direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    pub at_s: f64,
    pub uncertainty_s: f64,
}

impl StreamClock {
    /// `before_s`, `after_s`: times before and after the command that started the stream.
    pub fn new(period_s: f64, before_s: f64, after_s: f64) -> Self {
        let (first, last) = (-GRAIN_S, after_s - before_s + GRAIN_S);
        let drift = QUARTZ_TOLERANCE * period_s;
        let possible = vec![(first, -drift), (last, -drift), (last, drift), (first, drift)];
        Self { period_s, started_s: before_s, possible, looks: 0, soonest: None }
    }

    pub fn period_s(&self) -> f64 {
        self.period_s
    }

    /// Delay of the next read.
    pub fn delay_s(&self) -> f64 {
        let part = self.looks / LOOKS_BETWEEN % PARTS;
        if self.looks.is_multiple_of(LOOKS_BETWEEN) { part as f64 / PARTS as f64 * self.period_s } else { 0.0 }
    }

    /// Sample `number`, counted from 0, was the newest sample at `now_s`.
    pub fn newest(&mut self, number: u64, now_s: f64) {
        let late_s = now_s - self.nominal_s(number);
        if self.soonest.is_none_or(|(_, soonest_s)| late_s < soonest_s) {
            self.soonest = Some((number, late_s));
        }
        self.looks += 1;
        if self.looks.is_multiple_of(BLOCK)
            && let Some((number, late_s)) = self.soonest.take()
        {
            self.narrow(number as f64, late_s);
        }
    }

    pub fn moment(&self, number: u64) -> Moment {
        let (least_s, most_s) = self.range_s(number);
        let at_s = self.nominal_s(number) + 0.5 * (least_s + most_s);
        Moment { at_s, uncertainty_s: 0.5 * (most_s - least_s) }
    }

    /// Number of samples that must have arrived at `now_s`, unless the line is slower than usual.
    pub fn due(&self, now_s: f64) -> u64 {
        let count = |late_s: f64| ((now_s - self.started_s - late_s) / self.period_s).max(0.0) as u64;
        let (_, most_s) = self.range_s(count(0.0));
        count(most_s + SHORTEST_WAY_S + GRAIN_S)
    }

    fn nominal_s(&self, number: u64) -> f64 {
        self.started_s + (number + 1) as f64 * self.period_s
    }

    /// Smallest and largest possible deviation of a sample from its nominal time.
    fn range_s(&self, number: u64) -> (f64, f64) {
        let late_s = self.possible.iter().map(|(start_s, drift_s)| start_s + drift_s * number as f64);
        late_s.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), late| (least.min(late), most.max(late)))
    }

    fn narrow(&mut self, number: f64, late_s: f64) {
        let most_s = late_s + GRAIN_S;
        let least_s = late_s - self.period_s / PARTS as f64 - SHORTEST_WAY_S - GRAIN_S;
        let below = clip(&self.possible, |(start_s, drift_s)| most_s - start_s - drift_s * number);
        let mut within = clip(&below, |(start_s, drift_s)| start_s + drift_s * number - least_s);
        // Lines that nearly meet in one point add corners with every block.
        within.dedup_by(|a, b| (a.0 - b.0).abs() < 1e-9 && (a.1 - b.1).abs() < 1e-15);
        // Nothing left: transmission was slower than assumed for the whole block, so the block is ignored.
        if within.len() > 2 {
            self.possible = within;
        }
    }
}

/// The part of a convex polygon where `inside` is not negative (Sutherland and Hodgman 1974).
fn clip(polygon: &[(f64, f64)], inside: impl Fn((f64, f64)) -> f64) -> Vec<(f64, f64)> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, corner) in polygon.iter().enumerate() {
        let next = polygon[(i + 1) % polygon.len()];
        let (here, there) = (inside(*corner), inside(next));
        if here >= 0.0 {
            kept.push(*corner);
        }
        if (here < 0.0) != (there < 0.0) {
            let share = here / (here - there);
            kept.push((corner.0 + share * (next.0 - corner.0), corner.1 + share * (next.1 - corner.1)));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten minutes at 1000 samples per second, read every 4 ms, over a cable with a delay of 0.2 ms and occasionally
    /// more.
    fn check(quartz: f64, command_s: f64) {
        let period_s = 1e-3;
        let real_s = period_s * (1.0 + quartz);
        let taken_s = |number: u64| 2.0 + 0.4 * command_s + (number + 1) as f64 * real_s;
        let mut clock = StreamClock::new(period_s, 2.0, 2.0 + command_s);
        for look in 1..150_000_u64 {
            let now_s = 2.0 + look as f64 * 4e-3 + clock.delay_s();
            let way_s = 0.2e-3 + if look.is_multiple_of(7) { 9e-3 } else { 0.0 };
            let count = (now_s - way_s - taken_s(0)) / real_s;
            if count < 0.0 {
                continue;
            }
            let number = count as u64;
            clock.newest(number, now_s);
            let moment = clock.moment(number);
            let off_s = (moment.at_s - taken_s(number)).abs();
            assert!(off_s <= moment.uncertainty_s, "{off_s} s off, {moment:?}, quartz {quartz}");
            assert!(moment.uncertainty_s < 0.5e-3, "{moment:?} at {now_s} s, quartz {quartz}");
            assert!(way_s > 1e-3 || clock.due(now_s) <= number + 1, "{number} at {now_s} s");
        }
        assert!(clock.possible.len() < 60, "{} corners", clock.possible.len());
    }

    #[test]
    fn samples_are_placed_within_what_is_claimed() {
        for quartz in [0.0, 40e-6, -40e-6, 7e-6, -13e-6, 77e-6] {
            check(quartz, 0.0);
            check(quartz, 0.2e-3);
        }
    }

    #[test]
    fn a_line_that_is_always_slow_narrows_nothing() {
        let mut clock = StreamClock::new(1e-3, 0.0, 0.0);
        let before = clock.moment(100);
        (0..3000).for_each(|number| clock.newest(number, (number + 1) as f64 * 1e-3 + 0.2));
        assert_eq!(clock.moment(100), before);
    }
}
