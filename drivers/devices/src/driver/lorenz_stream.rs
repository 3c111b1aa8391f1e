//! The stream of a Lorenz sensor: both ranges at the rate of the sensor's own clock.

use super::stream_clock::StreamClock;
use super::{LorenzSensor, Range, Recovers};
use crate::protocol::lorenz::{Frames, Item, NOMINAL_COUNTS, PERIOD_STEP_S, ReadConfig, StartStream, StopStream};
use crate::transport::Link;
use jointbench_instrument::roles::{TorqueSample, TorqueStream};
use jointbench_instrument::units::{NewtonMetres, Seconds};
use jointbench_instrument::{Clock, Fault, FaultKind};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Configuration block of the rotor: nominal load of both channels.
const ROTOR_HEADER: u8 = 128;
const LOADS: [usize; 2] = [10, 14];
/// Longest delay of a sample, in periods.
const LATE_PERIODS: u32 = 3;
/// The index of a sample wraps after this many values.
const INDICES: u64 = 256;
/// Wait for samples that are due but missing. Samples that still do not arrive are delayed.
const LONGEST_WAIT: Duration = Duration::from_millis(20);

pub(super) struct Stream {
    clock: Arc<dyn Clock>,
    placed: StreamClock,
    frames: Frames,
    nominal_nm: [f64; 2],
    /// The range in use.
    range: Range,
    /// Number of the next frame.
    number: u64,
    received_s: f64,
    /// The same on the wall clock, because a bench clock may not advance while the driver listens.
    received_at: Instant,
    /// Time when frames were last found in the received bytes.
    found_s: f64,
    gap: Option<u64>,
}

impl Stream {
    /// Samples in order, up to a gap, which is kept for the next call.
    fn decode(&mut self, now_s: f64) -> Result<Vec<TorqueSample>, FaultKind> {
        let mut samples = Vec::new();
        while self.gap.is_none()
            && let Some(item) = self.frames.next()
        {
            match item {
                Item::Frame(frame) => {
                    let moment = self.placed.moment(self.number);
                    let torque_of = |channel: usize| in_range(frame.counts[channel], self.nominal_nm[channel]);
                    let [torque, other] = self.range.in_use_and_other().map(torque_of);
                    let (at_s, uncertainty_s) = (moment.at_s, moment.uncertainty_s);
                    samples.push(TorqueSample { number: self.number, at_s, uncertainty_s, torque, other });
                    self.number += 1;
                }
                Item::Gap { count } => {
                    // The index gives the number of missing samples modulo 256; the clock gives the multiple of 256.
                    let known = self.number + u64::from(count) + self.frames.waiting();
                    let due = self.placed.due(now_s);
                    if known > due + INDICES / 2 {
                        let what = "the stream repeats earlier samples".into();
                        return Err(FaultKind::Garbled { what });
                    }
                    let behind = due.saturating_sub(known);
                    let missing = u64::from(count) + (behind + INDICES / 2) / INDICES * INDICES;
                    self.gap = Some(missing);
                    self.number += missing;
                }
            }
        }
        Ok(samples)
    }

    fn arrived(&self) -> u64 {
        self.number + self.frames.waiting()
    }

    /// Reads the available bytes and waits briefly for samples that are due. Some reads are delayed by a fraction of
    /// the period.
    fn receive(&mut self, link: &mut Link) -> Result<f64, Fault> {
        let delay_s = self.placed.delay_s();
        if delay_s > 0.0 {
            self.clock.sleep_until_s(self.clock.now_s() + delay_s);
        }
        let now_s = self.clock.now_s();
        // A stream sends all the time, so half a deadline without a byte is its end. The fault is then known within two
        // deadlines.
        let silent = (link.deadline() / 2).max(LATE_PERIODS * Duration::from_secs_f64(self.placed.period_s()));
        let mut bytes = Vec::new();
        let mut wait = Duration::ZERO;
        while link.receive_unrequested(&mut bytes, wait)? > 0 || wait.is_zero() {
            if !bytes.is_empty() {
                (self.received_s, self.received_at) = (now_s, Instant::now());
                self.frames.push(&bytes);
                bytes.clear();
            }
            wait = LONGEST_WAIT.min(silent.saturating_sub(self.received_at.elapsed()));
            if self.arrived() >= self.placed.due(now_s) || wait.is_zero() {
                break;
            }
        }
        let waited = self.received_at.elapsed();
        if waited > silent || now_s - self.received_s > silent.as_secs_f64() {
            if link.receive_unrequested(&mut bytes, silent.saturating_sub(waited))? == 0 {
                let deadline_ms = silent.as_millis() as u64;
                return Err(link.fault(FaultKind::Silent { request: "the stream".into(), deadline_ms }));
            }
            (self.received_s, self.received_at) = (now_s, Instant::now());
            self.frames.push(&bytes);
        }
        Ok(now_s)
    }
}

/// `None` at and beyond the nominal torque, where the counts indicate an overload.
fn in_range(counts: i16, nominal_nm: f64) -> Option<NewtonMetres> {
    let within = counts.unsigned_abs() < NOMINAL_COUNTS.unsigned_abs();
    within.then(|| NewtonMetres(f64::from(counts) / f64::from(NOMINAL_COUNTS) * nominal_nm))
}

impl LorenzSensor {
    /// The range of each channel as stored in the rotor. It must agree with the bench description.
    pub(super) fn nominals(&mut self) -> Result<[f64; 2], Fault> {
        let header = self.ready()?.request(&ReadConfig { block: ROTOR_HEADER })?;
        let nominals = LOADS.map(|offset| f64::from(header.number::<2>(offset)));
        let (described_nm, found_nm) = match self.settings.range {
            Range::Coarse => (self.settings.nominal_nm, nominals[0]),
            Range::Fine => (self.settings.nominal_nm, nominals[1]),
        };
        if found_nm != described_nm {
            let what = format!(
                "the rotor header states ±{found_nm} Nm for the active range, the bench description ±{described_nm} \
                 Nm: correct nominal_nm"
            );
            return Err(self.link.fault(FaultKind::Refused { what }));
        }
        Ok(nominals)
    }
}

impl TorqueStream for LorenzSensor {
    fn start_stream(&mut self, period: Seconds, clock: Arc<dyn Clock>) -> Result<Seconds, Fault> {
        let steps = (period.0 / PERIOD_STEP_S).round();
        if !(1.0..=255.0).contains(&steps) {
            let what = format!("a stream with a period of {period}: choose 0.0002 s to 0.051 s");
            return Err(self.link.fault(FaultKind::Refused { what }));
        }
        self.stop_stream()?;
        let nominal_nm = self.nominals()?;
        let before_s = clock.now_s();
        self.ready()?.request(&StartStream { period: steps as u8 })?;
        let started_s = clock.now_s();
        let period_s = steps * PERIOD_STEP_S;
        let placed = StreamClock::new(period_s, before_s, started_s);
        let frames = Frames::default();
        let (range, received_at) = (self.settings.range, Instant::now());
        self.stream = Some(Stream {
            clock,
            placed,
            frames,
            nominal_nm,
            range,
            number: 0,
            received_s: started_s,
            received_at,
            found_s: started_s,
            gap: None,
        });
        Ok(Seconds(period_s))
    }

    fn collect(&mut self) -> Result<Vec<TorqueSample>, Fault> {
        let Some(stream) = &mut self.stream else {
            let what = "the stream was not started or was interrupted: start it";
            return Err(self.link.fault(FaultKind::Refused { what: what.into() }));
        };
        if let Some(count) = stream.gap.take() {
            return Err(self.link.fault(FaultKind::StreamGap { count }));
        }
        let collected = stream.receive(&mut self.link).and_then(|now_s| {
            let samples = stream.decode(now_s).map_err(|kind| self.link.fault(kind))?;
            if !samples.is_empty() || stream.gap.is_some() {
                stream.found_s = now_s;
            } else if now_s - stream.found_s > self.link.deadline().as_secs_f64() {
                let what = "no consecutive samples received".into();
                return Err(self.link.fault(FaultKind::Garbled { what }));
            }
            Ok((now_s, samples))
        });
        match collected {
            Ok((now_s, samples)) => {
                if let Some(newest) = stream.arrived().checked_sub(1)
                    && stream.gap.is_none()
                {
                    stream.placed.newest(newest, now_s);
                }
                Ok(samples)
            }
            Err(fault) => {
                self.stream = None;
                self.link.distrust();
                Err(fault)
            }
        }
    }

    fn stop_stream(&mut self) -> Result<(), Fault> {
        if self.stream.take().is_some() {
            self.link.distrust();
            self.link.send(&StopStream)?;
        }
        Ok(())
    }
}
