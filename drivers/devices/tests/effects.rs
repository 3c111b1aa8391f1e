//! Each hidden effect changes the measured torque as its true parameters say, and nothing else.

use jointbench_devices::sim::HiddenEffect;
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_instrument::Bench;
use jointbench_instrument::units::{Amperes, RadPerSec, Volts};

const PERIOD_S: f64 = 0.004;
const JOINT: Joint = Joint::JointB;
const SEED: u64 = 21;

struct Sample {
    friction_nm: f64,
    link_nm: f64,
    temperature_c: f64,
}

struct World {
    mock: MockBench,
    bench: Bench,
}

impl World {
    fn hiding(effects: &[&str]) -> Self {
        let mock = MockBench::start(MockSettings::new(JOINT, SEED).hiding(effects)).unwrap();
        let mut bench = mock.open_bench("mock").unwrap();
        bench.joint.arm(RadPerSec(320.0), Amperes(8.0)).unwrap();
        bench.brake.as_mut().unwrap().prepare(Volts(45.0)).unwrap();
        Self { mock, bench }
    }

    fn truth(&self) -> &HiddenEffect {
        &self.mock.truth().hidden[0]
    }

    /// Friction in blocks of 50 ms at constant speed, after one second to settle.
    fn blocks(&mut self, velocity_rad_s: f64, brake_a: f64, blocks: usize) -> Vec<Sample> {
        let ratio = self.bench.constants.gear_ratio;
        let torque_constant = self.bench.constants.torque_constant_nm_per_a;
        self.bench.brake.as_mut().unwrap().set_current(Amperes(brake_a)).unwrap();
        let start_s = self.bench.clock.now_s();
        for tick in 1..=10 {
            self.bench.joint.set_velocity(RadPerSec(velocity_rad_s)).unwrap();
            self.bench.clock.sleep_until_s(start_s + 0.1 * f64::from(tick));
        }
        let mut tick = 0;
        let mut block = || {
            let (mut friction_nm, mut link_nm) = (0.0, 0.0);
            self.bench.joint.set_velocity(RadPerSec(velocity_rad_s)).unwrap();
            for _ in 0..12 {
                tick += 1;
                self.bench.clock.sleep_until_s(start_s + 1.0 + f64::from(tick) * PERIOD_S);
                let joint = self.bench.joint.read().unwrap();
                let torque = self.bench.torque_sensor.as_mut().unwrap().read().unwrap();
                friction_nm += (torque_constant * joint.motor_current.0 - torque.0 / ratio) / 12.0;
                link_nm += torque.0 / 12.0;
            }
            let temperature_c = self.bench.joint.health().unwrap().temperature.unwrap().0;
            Sample { friction_nm, link_nm, temperature_c }
        };
        (0..blocks).map(|_| block()).collect()
    }

    fn mean(&mut self, velocity_rad_s: f64, brake_a: f64) -> Sample {
        let blocks = self.blocks(velocity_rad_s, brake_a, 12);
        let mean = |value: fn(&Sample) -> f64| blocks.iter().map(value).sum::<f64>() / blocks.len() as f64;
        Sample {
            friction_nm: mean(|s| s.friction_nm),
            link_nm: mean(|s| s.link_nm),
            temperature_c: mean(|s| s.temperature_c),
        }
    }
}

/// Extra friction of a joint with hidden `effect`, compared with the same specimen without it.
fn extra_nm(effect: &str, velocity_rad_s: f64, brake_a: f64) -> (f64, Sample, HiddenEffect) {
    let mut world = World::hiding(&[effect]);
    let with = world.mean(velocity_rad_s, brake_a);
    let without = World::hiding(&[]).mean(velocity_rad_s, brake_a);
    (with.friction_nm - without.friction_nm, with, world.truth().clone())
}

fn check(found_nm: f64, expected_nm: f64, budget_nm: f64, what: &str) {
    assert!((found_nm - expected_nm).abs() < budget_nm, "{what}: {found_nm:.5} Nm, expected {expected_nm:.5} Nm");
}

#[test]
fn stribeck_is_there_when_slow_and_gone_when_fast() {
    let (slow_nm, _, truth) = extra_nm("stribeck", 2.0, 0.0);
    let at = (2.0 / truth.parameters["velocity_rad_s"]).powf(truth.parameters["exponent"]);
    check(slow_nm, truth.parameters["rise_nm"] * (-at).exp(), 2e-3, "slow");
    let (fast_nm, ..) = extra_nm("stribeck", 120.0, 0.0);
    check(fast_nm, 0.0, 1e-3, "fast");
}

#[test]
fn load_raises_friction_in_proportion() {
    let (loaded_nm, sample, truth) = extra_nm("load_linear", 60.0, 0.5);
    assert!(sample.link_nm > 9.0, "the brake brakes: {} Nm", sample.link_nm);
    check(loaded_nm, truth.parameters["per_link_nm"] * sample.link_nm, 1.2e-3, "loaded");
}

#[test]
fn direction_offset_adds_one_way_and_takes_the_other() {
    let (forward_nm, _, truth) = extra_nm("direction_offset", 60.0, 0.0);
    let (backward_nm, ..) = extra_nm("direction_offset", -60.0, 0.0);
    check(forward_nm, truth.parameters["offset_nm"], 1e-3, "forward");
    check(backward_nm, truth.parameters["offset_nm"], 1e-3, "backward");
}

/// Half the peak-to-peak friction over more than one link turn.
fn swing_nm(effects: &[&str]) -> (f64, World) {
    let mut world = World::hiding(effects);
    let blocks = world.blocks(200.0, 0.0, 40);
    let friction = blocks.iter().map(|block| block.friction_nm);
    ((friction.clone().fold(f64::MIN, f64::max) - friction.fold(f64::MAX, f64::min)) / 2.0, world)
}

#[test]
fn gravity_and_ripple_swing_with_the_link() {
    let (plain_nm, _world) = swing_nm(&[]);
    assert!(plain_nm < 4e-3, "noise of blocks: {plain_nm:.5} Nm");
    let (gravity_nm, world) = swing_nm(&["gravity"]);
    let expected_nm = world.truth().parameters["link_nm"] / world.bench.constants.gear_ratio;
    check(gravity_nm, expected_nm, plain_nm + 1e-3, "gravity");
    let (ripple_nm, world) = swing_nm(&["friction_ripple"]);
    let expected_nm = world.truth().parameters["of_coulomb"] * world.mock.truth().coulomb_nm;
    check(ripple_nm, expected_nm, plain_nm + 1e-3, "ripple");
}

#[test]
fn grease_gets_thinner_as_it_warms() {
    let mut world = World::hiding(&["temperature_viscous"]);
    let cold = world.mean(250.0, 0.0);
    world.blocks(300.0, 0.0, 500);
    let warm = world.mean(250.0, 0.0);
    let per_k = world.truth().parameters["per_k"];
    let viscous_nm = world.mock.truth().viscous_nm_s * 250.0;
    let at = |temperature_c: f64| viscous_nm * (-per_k * (temperature_c - 25.0)).exp();
    assert!(warm.temperature_c > cold.temperature_c + 1.0, "{} → {}", cold.temperature_c, warm.temperature_c);
    let expected_nm = at(warm.temperature_c) - at(cold.temperature_c);
    check(warm.friction_nm - cold.friction_nm, expected_nm, 6e-4, "warm");
}
