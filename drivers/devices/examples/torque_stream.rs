//! What the torque sensor's stream loses, and how well its samples are placed among the joint's, on the mock bench.
//!
//! `cargo run --release -p jointbench-devices --example torque_stream -- [bench seconds] [seed]`

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

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let duration_s: f64 = arguments.next().map_or(Ok(600.0), |text| text.parse())?;
    let seed: u64 = arguments.next().map_or(Ok(1), |text| text.parse())?;
    let mock = MockBench::start(MockSettings::new(Joint::JointA, seed))?;
    let clock = mock.clock();
    let port = PortSettings::new(mock.address(MockInstrument::TorqueSensor).unwrap(), 230_400);
    let settings = LorenzSettings {
        name: "torque_sensor".into(),
        port,
        deadline_ms: DEADLINE_MS,
        range: Range::Fine,
        nominal_nm: 20.0,
    };
    let mut sensor = LorenzSensor::open(settings)?;
    let port = PortSettings::new(mock.address(MockInstrument::Joint).unwrap(), 921_600);
    let settings =
        OdriveSettings { name: "joint".into(), port, deadline_ms: DEADLINE_MS, link_encoder: true, thermistor: None };
    let mut joint = OdriveJoint::open(settings, clock.clone())?;

    let began = Instant::now();
    sensor.start_stream(Seconds(PERIOD_S), clock.clone())?;
    let start_s = clock.now_s();
    let (mut samples, mut lost, mut readings) = (0_u64, 0_u64, 0_u64);
    let mut uncertainties_s = Vec::new();
    for tick in 1..=(duration_s / TICK_S) as u64 {
        clock.sleep_until_s(start_s + tick as f64 * TICK_S);
        joint.read()?;
        readings += 1;
        match sensor.collect() {
            Ok(collected) => {
                samples += collected.len() as u64;
                uncertainties_s.extend(collected.iter().map(|sample| sample.uncertainty_s));
            }
            Err(fault) => match fault.kind {
                FaultKind::StreamGap { count } => lost += count,
                _ => return Err(fault.into()),
            },
        }
    }
    sensor.stop_stream()?;
    uncertainties_s.sort_by(f64::total_cmp);
    let share = |part: f64| 1e3 * uncertainties_s[((uncertainties_s.len() - 1) as f64 * part) as usize];
    let wall_s = began.elapsed().as_secs_f64();
    println!("{duration_s} s of the bench in {wall_s:.1} s: {:.0} times real time", duration_s / wall_s);
    println!("{samples} torque samples, {lost} lost, beside {readings} joint readings");
    println!(
        "placed within ±{:.2} ms (median), ±{:.2} ms (95 %), ±{:.2} ms (worst)",
        share(0.5),
        share(0.95),
        share(1.0)
    );
    Ok(())
}
