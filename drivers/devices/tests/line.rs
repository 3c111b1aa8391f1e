//! The load of the joint, as the torque sensor measures it.

use jointbench_devices::sim::Load;
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_instrument::Bench;
use jointbench_instrument::units::{Amperes, RadPerSec, Volts};

const TICK_S: f64 = 0.02;

fn open(joint: Joint, load: Load) -> (MockBench, Bench) {
    let mock = MockBench::start(MockSettings { load, ..MockSettings::new(joint, 3) }).unwrap();
    let mut bench = mock.open_bench("mock").unwrap();
    bench.joint.arm(RadPerSec(320.0), Amperes(8.0)).unwrap();
    bench.brake.as_mut().unwrap().prepare(Volts(45.0)).unwrap();
    (mock, bench)
}

/// Link torques at a motor speed and a brake current, one reading per tick.
fn stretch(bench: &mut Bench, velocity_rad_s: f64, brake_a: f64, seconds: f64) -> Vec<f64> {
    bench.brake.as_mut().unwrap().set_current(Amperes(brake_a)).unwrap();
    let ticks = (seconds / TICK_S) as usize;
    let reading = |_| {
        bench.joint.set_velocity(RadPerSec(velocity_rad_s)).unwrap();
        bench.clock.sleep_until_s(bench.clock.now_s() + TICK_S);
        bench.torque_sensor.as_mut().unwrap().read().unwrap().0
    };
    (0..ticks).map(reading).collect()
}

fn settled(bench: &mut Bench, velocity_rad_s: f64, brake_a: f64, seconds: f64) -> f64 {
    let torques = stretch(bench, velocity_rad_s, brake_a, seconds);
    let tail = &torques[torques.len() / 2..];
    tail.iter().sum::<f64>() / tail.len() as f64
}

#[test]
fn gear_and_brake_b_break_away_and_depend_on_speed() {
    let (_mock, mut bench) = open(Joint::JointA, Load::GearAndBrakeB);
    let start = stretch(&mut bench, 4.0, 0.0, 3.0);
    let breakaway_nm = start.iter().copied().fold(f64::MIN, f64::max);
    let unloaded = [40.0, 110.0, 300.0].map(|velocity| settled(&mut bench, velocity, 0.0, 2.0));
    assert!(breakaway_nm > unloaded[1] + 0.5, "{breakaway_nm} Nm to begin with, {unloaded:?} Nm when turning");
    assert!(unloaded[2] > unloaded[1] + 0.1, "more again when fast: {unloaded:?} Nm");
    assert!(unloaded.iter().all(|torque| (1.5..6.0).contains(torque)), "{unloaded:?} Nm");
    let loaded_nm = settled(&mut bench, 110.0, 0.25, 3.0);
    assert!((35.0..60.0).contains(&loaded_nm), "{loaded_nm} Nm, far beyond what brake A could hold");
}

#[test]
fn brake_a_cogs_after_a_decrease_at_standstill_until_ramped_down_while_turning() {
    let (_mock, mut bench) = open(Joint::JointB, Load::BrakeA);
    /// Peak-to-peak torque over more than one turn of the link.
    fn swing_nm(bench: &mut Bench) -> f64 {
        let torques = stretch(bench, 50.0, 0.0, 8.0);
        let tail = &torques[torques.len() / 5..];
        tail.iter().copied().fold(f64::MIN, f64::max) - tail.iter().copied().fold(f64::MAX, f64::min)
    }
    let clean_nm = swing_nm(&mut bench);
    stretch(&mut bench, 50.0, 0.5, 1.0);
    stretch(&mut bench, 0.0, 0.5, 1.0);
    stretch(&mut bench, 0.0, 0.0, 1.0);
    let cogging_nm = swing_nm(&mut bench);
    assert!(cogging_nm > 0.8, "{cogging_nm} Nm peak to peak after a decrease at standstill");
    stretch(&mut bench, 100.0, 0.5, 1.0);
    for step in (0..=40).rev() {
        stretch(&mut bench, 100.0, 0.5 * f64::from(step) / 40.0, 0.1);
    }
    let left_nm = swing_nm(&mut bench);
    assert!(left_nm < clean_nm + 0.065, "{left_nm} Nm left, {clean_nm} Nm before: more than 0.5 % of the rating");
}
