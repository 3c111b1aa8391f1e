//! Lost samples of the torque stream, and the timing error of its samples relative to the joint, on the mock bench.

use super::row;
use jointbench_devices::driver::{LorenzSettings, OdriveSettings, Range};
use jointbench_devices::sim::MockInstrument;
use jointbench_devices::{Joint, LorenzSensor, MockBench, MockSettings, OdriveJoint, PortSettings};
use jointbench_instrument::FaultKind;
use jointbench_instrument::roles::{JointController, TorqueStream};
use jointbench_instrument::units::Seconds;
use std::error::Error;
use std::time::Instant;

const PERIOD_S: f64 = 1e-3;
const TICK_S: f64 = 4e-3;
const DEADLINE_MS: u64 = 3000;

pub fn stream(duration_s: f64) -> Result<(), Box<dyn Error>> {
    let mock = MockBench::start(MockSettings::new(Joint::JointA, 1))?;
    let clock = mock.clock();
    let port = |instrument: MockInstrument| {
        mock.address(instrument).map(|address| PortSettings::new(address, instrument.baud())).ok_or("not on this bench")
    };
    let settings = LorenzSettings {
        name: "torque_sensor".into(),
        port: port(MockInstrument::TorqueSensor)?,
        deadline_ms: DEADLINE_MS,
        range: Range::Fine,
        nominal_nm: 20.0,
    };
    let mut sensor = LorenzSensor::open(settings)?;
    let settings = OdriveSettings {
        name: "joint".into(),
        port: port(MockInstrument::Joint)?,
        deadline_ms: DEADLINE_MS,
        link_encoder: true,
        thermistor: None,
    };
    let mut joint = OdriveJoint::open(settings, clock.clone())?;

    let began = Instant::now();
    sensor.start_stream(Seconds(PERIOD_S), clock.clone())?;
    let start_s = clock.now_s();
    let (mut samples, mut lost, mut readings) = (0_u64, 0_u64, 0_u64);
    let mut skews_s = Vec::new();
    for tick in 1..=(duration_s / TICK_S) as u64 {
        clock.sleep_until_s(start_s + tick as f64 * TICK_S);
        let reading = joint.read()?;
        readings += 1;
        match sensor.collect() {
            Ok(collected) => {
                samples += collected.len() as u64;
                skews_s.extend(collected.iter().map(|sample| sample.uncertainty_s + reading.uncertainty_s));
            }
            Err(fault) => match fault.kind {
                FaultKind::StreamGap { count } => lost += count,
                _ => return Err(fault.into()),
            },
        }
    }
    sensor.stop_stream()?;
    skews_s.sort_by(f64::total_cmp);
    let share = |part: f64| 1e3 * skews_s[((skews_s.len() - 1) as f64 * part) as usize];
    let times = duration_s / began.elapsed().as_secs_f64();
    row(
        &format!("torque stream of 1,000 samples a second over {duration_s:.0} s of the bench: lost"),
        format!("{lost} of {samples}, in parallel with {readings} readings of the joint"),
        "0",
    );
    row("its skew to the joint's samples is known to, median", format!("±{:.2} ms", share(0.5)), "");
    row("the same, worst", format!("±{:.2} ms", share(1.0)), "≤ 0.5 ms");
    row("the bench meanwhile", format!("{times:.0} × real time"), "≥ 50 ×");
    Ok(())
}
