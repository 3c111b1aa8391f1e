//! The torque sensor's stream with and without troubles.

use super::{DEADLINE, settings};
use jointbench_devices::driver::{LorenzSettings, Range};
use jointbench_devices::sim::{MockInstrument, Transport, Trouble};
use jointbench_devices::{LorenzSensor, MockBench, PortSettings};
use jointbench_instrument::roles::{Instrument, TorqueSample, TorqueSensor, TorqueStream};
use jointbench_instrument::units::Seconds;
use jointbench_instrument::{Clock, Fault, FaultKind};
use std::sync::Arc;

/// Interval at which the bench owner collects samples.
const TICK_S: f64 = 0.004;

struct World {
    mock: MockBench,
    clock: Arc<dyn Clock>,
    sensor: LorenzSensor,
    samples: Vec<TorqueSample>,
    gaps: Vec<u64>,
}

fn sensor(mock: &MockBench, nominal_nm: f64) -> LorenzSensor {
    let port = PortSettings::new(mock.address(MockInstrument::TorqueSensor).unwrap(), 230_400);
    let deadline_ms = DEADLINE.as_millis() as u64;
    let range = Range::Fine;
    LorenzSensor::open(LorenzSettings { name: "torque".into(), port, deadline_ms, range, nominal_nm }).unwrap()
}

impl World {
    fn streaming(transport: Transport) -> Self {
        let mock = MockBench::start(settings(transport)).unwrap();
        let mut sensor = sensor(&mock, 20.0);
        let clock = mock.clock();
        clock.sleep_until_s(1.0);
        assert_eq!(sensor.start_stream(Seconds(1e-3), clock.clone()).unwrap(), Seconds(1e-3));
        Self { mock, clock, sensor, samples: Vec::new(), gaps: Vec::new() }
    }

    /// Collects for `seconds`, gaps included. Any other fault ends the collection.
    fn collect(&mut self, seconds: f64) -> Result<(), Fault> {
        let start_s = self.clock.now_s();
        for tick in 1..=(seconds / TICK_S).round() as u32 {
            self.clock.sleep_until_s(start_s + f64::from(tick) * TICK_S);
            match self.sensor.collect() {
                Ok(samples) => self.samples.extend(samples),
                Err(Fault { kind: FaultKind::StreamGap { count }, .. }) => self.gaps.push(count),
                Err(fault) => return Err(fault),
            }
        }
        Ok(())
    }
}

#[test]
fn every_sample_comes_once_and_in_its_place() {
    for transport in [Transport::Terminal, Transport::Tcp] {
        let mut world = World::streaming(transport);
        world.collect(4.0).unwrap();
        let numbers: Vec<u64> = world.samples.iter().map(|sample| sample.number).collect();
        assert!((3990..=4000).contains(&numbers.len()), "{} samples", numbers.len());
        assert!(numbers.iter().zip(0..).all(|(number, expected)| *number == expected));
        assert!(world.gaps.is_empty());
        for sample in &world.samples {
            // 40 ppm of 4 s, and the uncertainty that the timing reports.
            let off_s = (sample.at_s - 1.0 - (sample.number + 1) as f64 * 1e-3).abs();
            assert!(off_s < 0.2e-3 + sample.uncertainty_s && sample.uncertainty_s < 0.5e-3, "{sample:?}");
            assert!(sample.torque.unwrap().0.abs() < 0.1, "{sample:?}");
        }
        world.sensor.stop_stream().unwrap();
        assert!(world.sensor.read().unwrap().0.abs() < 0.1, "single readings again");
    }
}

/// The readings of the joint have times of the bench clock too, so this is the skew between both.
#[test]
fn in_ten_minutes_no_sample_is_lost_and_each_is_placed_within_half_a_millisecond() {
    let mut world = World::streaming(Transport::Inside);
    world.collect(600.0).unwrap();
    assert!(world.gaps.is_empty() && world.samples.len() >= 599_900, "{} samples", world.samples.len());
    assert!(world.samples.iter().zip(0..).all(|(sample, expected)| sample.number == expected));
    let widest_s = world.samples.iter().map(|sample| sample.uncertainty_s).fold(0.0, f64::max);
    assert!(widest_s < 0.5e-3, "{widest_s} s");
}

#[test]
fn a_gap_is_named_with_its_length_and_no_sample_stands_in_it() {
    let mut world = World::streaming(Transport::Terminal);
    world.collect(1.2).unwrap();
    world.mock.trouble(MockInstrument::TorqueSensor, Trouble::StreamGap);
    world.collect(2.0).unwrap();
    // Seven lost frames, and the frame before, which no later frame confirms.
    assert!(world.gaps.len() >= 3 && world.gaps.iter().all(|count| *count == 8), "{:?}", world.gaps);
    let steps: Vec<u64> = world.samples.windows(2).map(|pair| pair[1].number - pair[0].number).collect();
    assert_eq!(steps.iter().filter(|step| **step == 9).count(), world.gaps.len());
    assert!(steps.iter().all(|step| [1, 9].contains(step)));
    let last = world.samples.last().unwrap();
    assert!((world.clock.now_s() - last.at_s).abs() < 0.02, "still in its place: {last:?}");
}

#[test]
fn a_stream_that_ends_by_itself_is_silence() {
    let mut world = World::streaming(Transport::Terminal);
    world.collect(0.2).unwrap();
    world.mock.trouble(MockInstrument::TorqueSensor, Trouble::PowerCycled);
    let since_s = world.clock.now_s();
    let fault = world.collect(10.0).unwrap_err();
    assert!(matches!(fault.kind, FaultKind::Silent { .. }), "{fault}");
    let seen_s = world.clock.now_s() - since_s;
    assert!(seen_s < 2.0 * DEADLINE.as_secs_f64(), "after {seen_s} s");
    assert!(world.samples.len() <= 200, "{}", world.samples.len());
    assert!(world.sensor.collect().unwrap_err().to_string().contains("start it"));
    world.mock.trouble(MockInstrument::TorqueSensor, Trouble::None);
    world.sensor.start_stream(Seconds(1e-3), world.clock.clone()).unwrap();
    let before = world.samples.len();
    world.collect(0.2).unwrap();
    assert!(world.samples.len() > before + 150, "usable again");
}

/// A stream that continues comes from the sensor that was commanded. Another sensor has to be commanded first.
#[test]
fn another_sensor_in_the_place_of_one_that_streams_is_named() {
    let mut world = World::streaming(Transport::Terminal);
    world.collect(0.2).unwrap();
    world.mock.trouble(MockInstrument::TorqueSensor, Trouble::Exchanged);
    let fault = world.collect(10.0).unwrap_err();
    assert!(matches!(fault.kind, FaultKind::Silent { .. }), "{fault}");
    assert!(world.samples.len() <= 200, "{}", world.samples.len());
    let fault = world.sensor.recover().unwrap_err();
    assert!(matches!(fault.kind, FaultKind::WrongInstrument { .. }), "{fault}");
}

#[test]
fn both_ranges_come_and_the_small_one_saturates_alone() {
    let mut world = World::streaming(Transport::Terminal);
    world.mock.trouble(MockInstrument::TorqueSensor, Trouble::Saturated);
    world.collect(0.2).unwrap();
    let sample = world.samples.last().unwrap();
    assert_eq!(sample.torque, None);
    assert!((sample.other.unwrap().0 - 27.0).abs() < 0.3, "{sample:?}");
}

#[test]
fn what_cannot_be_streamed_is_refused() {
    let mut world = World::streaming(Transport::Terminal);
    assert!(matches!(world.sensor.read().unwrap_err().kind, FaultKind::Refused { .. }));
    world.collect(0.1).unwrap();
    assert!(world.samples.len() > 80, "the stream goes on");
    for period_s in [0.0, 1.0, f64::NAN] {
        let fault = world.sensor.start_stream(Seconds(period_s), world.clock.clone()).unwrap_err();
        assert!(matches!(fault.kind, FaultKind::Refused { .. }), "{fault}");
    }
    // Five bytes every 200 µs exceed the capacity of the line.
    let fault = world.sensor.start_stream(Seconds(2e-4), world.clock.clone()).unwrap_err();
    assert!(matches!(fault.kind, FaultKind::Refused { .. }), "{fault}");

    let mock = MockBench::start(settings(Transport::Terminal)).unwrap();
    let fault = sensor(&mock, 25.0).start_stream(Seconds(1e-3), mock.clock()).unwrap_err();
    assert!(fault.to_string().contains("±20 Nm") && fault.to_string().contains("nominal_nm"), "{fault}");
}
