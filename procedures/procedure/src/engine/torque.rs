//! The torque of a tick: one reading, or the mean of the stream since the previous tick.

use super::ask::RequestFault;
use super::ending::Ending;
use super::session::{RECOVERIES_PER_STEP, Session, TorqueStream, log};
use super::skew::{self, SkewRange};
use crate::columns::TickTorque;
use jointbench_instrument::clock::{Timed, timed};
use jointbench_instrument::roles::{JointReading, TorqueSample, TorqueSensor};
use jointbench_instrument::units::Seconds;
use jointbench_instrument::{Clock, Fault, FaultKind};
use std::sync::Arc;

/// Periods until the first sample of a stream, including its transmission.
const FIRST_PERIODS: f64 = 2.0;

/// Torque of one tick.
#[derive(Debug, Clone, Copy)]
struct TorqueReading {
    nm: f64,
    peak_nm: f64,
    other_nm: Option<f64>,
}

impl Session<'_> {
    /// Starts the torque stream if the plan requires it and the sensor supports it.
    pub(super) fn start_torque_stream(&mut self) -> Result<(), Ending> {
        let Some(period_s) = self.plan.torque_period_s else { return Ok(()) };
        let clock = Arc::clone(&self.bench.clock);
        let started = self.ask_torque_sensor(|sensor| match sensor.as_stream() {
            Some(stream) => stream.start_stream(Seconds(period_s), Arc::clone(&clock)).map(Some),
            None => Ok(None),
        })?;
        self.torque_stream = started.flatten().map(|period| TorqueStream { period, samples: 0, missing: 0 });
        if let Some(TorqueStream { period, .. }) = self.torque_stream {
            clock.sleep_until_s(clock.now_s() + FIRST_PERIODS * period.0);
        }
        Ok(())
    }

    /// Returns to single readings, and reports the statistics of the stream.
    pub(super) fn stop_torque_stream(&mut self) -> Result<(), Ending> {
        let Some(TorqueStream { period, samples, missing }) = self.torque_stream.take() else { return Ok(()) };
        let rate_hz = 1.0 / period.0;
        self.note(format!("{samples} torque samples at {rate_hz:.0} Hz, averaged per row."));
        if missing > 0 {
            self.warn(format!("lost samples: {missing} torque samples are missing, {samples} were received"));
        }
        let sensor = self.bench.torque_sensor.as_mut();
        if let Some(Err(fault)) = sensor.and_then(|sensor| sensor.as_stream()).map(|stream| stream.stop_stream()) {
            self.note(format!("The torque stream could not be stopped: {fault}"));
        }
        Ok(())
    }

    /// `None`: no sensor, or no sample of its stream.
    pub(super) fn read_torque(&mut self, joint: &JointReading) -> Result<Option<TickTorque>, Ending> {
        if self.failed.sensor {
            return Ok(None);
        }
        let reading = if self.torque_stream.is_some() { self.average_torque()? } else { self.read_single_torque()? };
        let Some(reading) = reading else { return Ok(None) };
        let skew = skew::of(joint, &reading);
        self.skews = Some(SkewRange::add(self.skews, skew));
        let TorqueReading { nm, peak_nm, other_nm } = reading.value;
        Ok(Some(TickTorque { nm, peak_nm, other_nm, skew_s: skew.s }))
    }

    fn read_single_torque(&mut self) -> Result<Option<Timed<TorqueReading>>, Ending> {
        let clock = Arc::clone(&self.bench.clock);
        let both = self.plan.both_ranges;
        let read = |sensor: &mut (dyn TorqueSensor + 'static)| {
            let (torque, other) = if both { sensor.read_both()? } else { (sensor.read()?, None) };
            Ok(TorqueReading { nm: torque.0, peak_nm: torque.0, other_nm: other.map(|other| other.0) })
        };
        self.ask_torque_sensor(|sensor| timed(&*clock, || read(sensor)))
    }

    /// The mean of the samples of one period of the run, at the mean of their times.
    fn average_torque(&mut self) -> Result<Option<Timed<TorqueReading>>, Ending> {
        let clock = Arc::clone(&self.bench.clock);
        let Some(period) = self.torque_stream.map(|streaming| streaming.period) else { return Ok(None) };
        let both = self.plan.both_ranges;
        let mut samples = loop {
            let mut ended = false;
            let collected = self.ask_torque_sensor(|sensor| {
                let collected = collect(sensor, std::mem::take(&mut ended).then_some(period), &clock, both);
                ended = collected.is_err();
                collected
            })?;
            match collected {
                Some(Ok(samples)) => break samples,
                Some(Err(gap)) => self.pass_gap(gap)?,
                None => return Ok(None),
            }
        };
        if let Some(streaming) = &mut self.torque_stream {
            streaming.samples += samples.len() as u64;
        }
        let Some(newest_s) = samples.last().map(|sample| sample.at_s) else { return Ok(None) };
        // Older samples belong to a tick that was skipped.
        samples.retain(|sample| sample.at_s > newest_s - self.period.duration_s);
        let count = samples.len() as f64;
        let mean = |of: fn(&TorqueSample) -> f64| samples.iter().map(of).sum::<f64>() / count;
        let in_use = |sample: &TorqueSample| sample.torque.map_or(0.0, |torque| torque.0);
        let peak_nm =
            samples.iter().map(in_use).fold(0.0, |peak: f64, nm| if nm.abs() > peak.abs() { nm } else { peak });
        let value = TorqueReading {
            nm: mean(in_use),
            peak_nm,
            other_nm: both.then(|| mean(|sample| sample.other.map_or(0.0, |other| other.0))),
        };
        let uncertainty_s = samples.iter().map(|sample| sample.uncertainty_s).fold(0.0, f64::max);
        Ok(Some(Timed { value, at_s: mean(|sample| sample.at_s), uncertainty_s }))
    }

    /// A gap is not filled. The stream continues.
    fn pass_gap(&mut self, gap: Fault) -> Result<(), Ending> {
        if let (FaultKind::StreamGap { count }, Some(streaming)) = (&gap.kind, &mut self.torque_stream) {
            streaming.missing += count;
        }
        let now_s = self.bench.clock.now_s();
        log(&mut self.journal, &mut self.recoveries, now_s, RequestFault { fault: gap.clone(), recovered: true });
        if self.recoveries > RECOVERIES_PER_STEP {
            self.failed.sensor = true;
            return Err(Ending::OtherFault(gap));
        }
        Ok(())
    }
}

/// Samples, or the gap before the next ones. `anew`: the stream has ended and restarts with this period.
fn collect(
    sensor: &mut dyn TorqueSensor,
    anew: Option<Seconds>,
    clock: &Arc<dyn Clock>,
    both: bool,
) -> Result<Result<Vec<TorqueSample>, Fault>, Fault> {
    let Some(stream) = sensor.as_stream() else { return Ok(Ok(Vec::new())) };
    if let Some(period) = anew {
        stream.start_stream(period, Arc::clone(clock))?;
    }
    let samples = match stream.collect() {
        Err(gap @ Fault { kind: FaultKind::StreamGap { .. }, .. }) => return Ok(Err(gap)),
        collected => collected?,
    };
    if samples.iter().any(|sample| sample.torque.is_none() || both && sample.other.is_none()) {
        let what = format!("a sample of the stream beyond ±{} Nm; use the larger range", sensor.range().0);
        return Err(FaultKind::Saturated { what }.at(sensor.name(), sensor.port()));
    }
    Ok(Ok(samples))
}
